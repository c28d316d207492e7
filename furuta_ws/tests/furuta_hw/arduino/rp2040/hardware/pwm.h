#include <stdint.h>
unsigned pwm_gpio_to_slice_num(unsigned pin);
void pwm_set_wrap(unsigned slice, uint16_t top);
void pwm_set_clkdiv_int_frac(unsigned slice, uint8_t integer, uint8_t fraction);
void pwm_set_gpio_level(unsigned pin, uint16_t level);
void pwm_set_enabled(unsigned slice, bool enabled);
