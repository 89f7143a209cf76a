/* Root of a rising function, by bisection and secants. */
#include "sim_root.h"

#include <math.h>

/* Root of a rising function between low and high, whose values are given. False position
 * (Illinois): an end that stays for a second time counts half. */
double sim_root(sim_rising value_at, const void *context, double low, double low_value, double high,
                double high_value, double at_tolerance, double value_tolerance)
{
    for (int i = 0; i < 60 && high - low > at_tolerance; i++) {
        double middle = high - high_value * (high - low) / (high_value - low_value);
        double value = value_at(context, middle);
        if (fabs(value) < value_tolerance) {
            return middle;
        }
        if (value < 0.0) {
            low = middle;
            low_value = value;
            high_value *= 0.5;
        } else {
            high = middle;
            high_value = value;
            low_value *= 0.5;
        }
    }
    return high;
}
