#include <stdint.h>
enum { IO_IRQ_BANK0 = 13, PICO_HIGHEST_IRQ_PRIORITY = 0 };
void irq_set_priority(unsigned number, uint8_t priority);
