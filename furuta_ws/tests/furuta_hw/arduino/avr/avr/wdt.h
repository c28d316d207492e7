#include <stdint.h>
enum { WDTO_120MS = 3 };
void wdt_disable();
void wdt_enable(uint8_t timeout);
void wdt_reset();
