// The least of an Arduino that the emitted sketch needs: board.cpp is its board.
#ifndef ARDUINO_H
#define ARDUINO_H

#include <stdint.h>

static const uint8_t A0 = 14;
static const uint8_t OUTPUT = 1;

unsigned long micros(void);
int analogRead(uint8_t pin);
void analogWrite(uint8_t pin, int value);
void pinMode(uint8_t pin, uint8_t mode);
void setup(void);
void loop(void);

struct Port {
    void begin(unsigned long baud);
    void print(const char *text);
    void println(int number);
};
extern Port Serial;

#endif
