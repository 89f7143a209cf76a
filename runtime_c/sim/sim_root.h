/* The root of a rising function between two signs. */
#ifndef SIM_ROOT_H
#define SIM_ROOT_H

typedef double (*sim_rising)(const void *context, double at);

/* low_value < 0 <= high_value: of the function at low and high. Ends where the value is within
 * value_tolerance of zero, or the bracket within at_tolerance. */
double sim_root(sim_rising value_at, const void *context, double low, double low_value, double high,
                double high_value, double at_tolerance, double value_tolerance);

#endif
