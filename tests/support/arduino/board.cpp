// A board whose tool is pressed once, whose program stalls twice, and which tells of every duty.
#include <Arduino.h>
#include <stdio.h>

static unsigned long now_us = 4294967296ul - 100000ul; // the counter of 32 bits wraps on the way
static const unsigned long begin_us = now_us;
static bool stalled[2];
Port Serial;

unsigned long micros(void)
{
    return now_us & 0xfffffffful;
}

static unsigned long passed_us(void)
{
    return now_us - begin_us;
}

int analogRead(uint8_t)
{
    const unsigned long at_us = passed_us();
    return at_us < 250000ul ? static_cast<int>(at_us / 400ul) : 625;
}

void analogWrite(uint8_t, int value)
{
    printf("%lu %d\n", passed_us(), value);
}

void pinMode(uint8_t, uint8_t) {}

void Port::begin(unsigned long) {}

void Port::print(const char *text)
{
    printf("said %s", text);
}

void Port::println(int number)
{
    printf("%d\n", number);
}

int main()
{
    setup();
    while (passed_us() < 800000ul) {
        now_us += 50;
        const int at = passed_us() > 500000ul ? 1 : 0;
        if (passed_us() > 300000ul && !stalled[at]) {
            stalled[at] = true;
            now_us += at == 0 ? 5000ul : 100000ul;
        }
        loop();
    }
    return 0;
}
