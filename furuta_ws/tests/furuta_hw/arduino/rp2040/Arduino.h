/* Stand-in for the Arduino core of the RP2040. */
#include "arduino_common.h"

#define F_CPU 133000000u
enum { GPIO_FUNC_PWM = 4 };

void gpio_set_function(unsigned pin, int function);
