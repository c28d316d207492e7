/* Stand-in for what the Arduino cores of all boards declare, as far as the boards use it. */
#ifndef ARDUINO_COMMON_H
#define ARDUINO_COMMON_H

#include <stddef.h>
#include <stdint.h>

enum { LOW, HIGH };
enum { INPUT, OUTPUT, INPUT_PULLUP };
enum { CHANGE = 4 };

void pinMode(uint8_t pin, uint8_t mode);
void digitalWrite(uint8_t pin, uint8_t level);
int digitalRead(uint8_t pin);
int analogRead(uint8_t pin);
void analogWrite(uint8_t pin, int value);
void attachInterrupt(uint8_t interrupt, void (*function)(), int mode);
void noInterrupts();
void interrupts();
void setup();
void loop();

#define digitalPinToInterrupt(pin) (pin)

struct SerialPort {
    void begin(unsigned long baud);
    int read();
    int availableForWrite();
    size_t write(const uint8_t *data, size_t length);
    void send_now();
};
extern SerialPort Serial;

#endif
