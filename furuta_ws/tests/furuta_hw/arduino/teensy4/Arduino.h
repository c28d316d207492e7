/* Stand-in for the Arduino core of the Teensy 4. */
#include "arduino_common.h"

enum { A0 = 14 };

void digitalWriteFast(uint8_t pin, uint8_t level);
uint8_t digitalReadFast(uint8_t pin);
uint32_t analogWriteResolution(uint32_t bits);
void analogWriteFrequency(uint8_t pin, float frequency);
void analogReadResolution(unsigned int bits);
void analogReadAveraging(unsigned int count);

struct IntervalTimer {
    bool begin(void (*function)(), unsigned long period_us);
    void end();
    void priority(uint8_t priority);
};

extern volatile uint32_t CCM_CCGR5, WDOG3_CS, WDOG3_CNT, WDOG3_TOVAL;
#define CCM_CCGR_ON 3
#define CCM_CCGR5_WDOG3(n) ((uint32_t)(n) << 4)
#define WDOG_CS_UPDATE (1u << 5)
#define WDOG_CS_EN (1u << 7)
#define WDOG_CS_CLK(n) ((uint32_t)(n) << 8)
#define WDOG_CS_RCS (1u << 10)
#define WDOG_CS_ULK (1u << 11)
#define WDOG_CS_CMD32EN (1u << 13)
