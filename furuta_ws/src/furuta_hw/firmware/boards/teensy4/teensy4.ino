/* Teensy 4.0 or 4.1: two encoders or an encoder and an analogue sensor, an H-bridge.
   docs/firmware.md has the wiring. Compiled against stand-in headers only: not yet tried on a
   real board. */

/* Your rig. */
static const bool PENDULUM_IS_ENCODER = true; /* false: a potentiometer or Hall sensor */
static const int FAULT_LEVEL = HIGH;          /* of the fault input; HIGH if it is open */

static const uint8_t ARM_A = 2, ARM_B = 3;
static const uint8_t PENDULUM_A = 4, PENDULUM_B = 5;
static const uint8_t PENDULUM_ANALOGUE = A0;
static const uint8_t PWM_PIN = 9, DIRECTION_PIN = 10, ENABLE_PIN = 11, FAULT_PIN = 12;

static const unsigned DRIVE_BITS = 11; /* and the sign: codes of 12 bits */
static const float PWM_FREQUENCY = 20000.0f;
static const unsigned ANALOGUE_BITS = 12;
/* Encoders interrupt the timer, whose default is 128; lower numbers come first. */
static const uint8_t TIMER_PRIORITY = 192;

/* The watchdog RTWDOG runs on the clock of 32.768 kHz. Keys: i.MX RT1060 reference manual,
   chapter RTWDOG. */
static const uint32_t WATCHDOG_TICKS = 3277; /* 0.1 s */
static const uint32_t WATCHDOG_UNLOCK = 0xD928C520u, WATCHDOG_REFRESH = 0xB480A602u;

#include <furuta_arduino.h>

static volatile struct furuta_encoder pendulum;
static IntervalTimer timer;

static void pendulum_edge() {
    furuta_encoder_move(&pendulum, digitalRead(PENDULUM_A), digitalRead(PENDULUM_B));
}

static void start_watchdog() {
    CCM_CCGR5 |= CCM_CCGR5_WDOG3(CCM_CCGR_ON);
    noInterrupts();
    WDOG3_CNT = WATCHDOG_UNLOCK;
    while ((WDOG3_CS & WDOG_CS_ULK) == 0) {
    }
    WDOG3_TOVAL = WATCHDOG_TICKS;
    WDOG3_CS = WDOG_CS_CMD32EN | WDOG_CS_CLK(1) | WDOG_CS_UPDATE | WDOG_CS_EN;
    while ((WDOG3_CS & WDOG_CS_RCS) == 0) {
    }
    interrupts();
}

struct furuta_limits board_limits(void) {
    struct furuta_limits limits;
    limits.shortest_period_us = 200;
    limits.longest_period_us = 20000;
    limits.longest_watchdog = 500;
    limits.lowest_code = -2048;
    limits.highest_code = 2047;
    limits.zero_code = 0;
    return limits;
}

void board_write(const uint8_t *data, uint8_t length) {
    if (Serial.availableForWrite() >= length) {
        Serial.write(data, length);
        Serial.send_now();
    }
}

int32_t board_arm(void) { return arm.count; }

int32_t board_pendulum(void) {
    if (PENDULUM_IS_ENCODER) {
        return pendulum.count;
    }
    return analogRead(PENDULUM_ANALOGUE) - (1 << (ANALOGUE_BITS - 1));
}

void board_drive(int16_t code) {
    digitalWriteFast(DIRECTION_PIN, code < 0 ? LOW : HIGH);
    analogWrite(PWM_PIN, code < 0 ? -code : code);
}

void board_start_timer(uint32_t period_us) {
    timer.end();
    timer.priority(TIMER_PRIORITY);
    timer.begin(furuta_tick, (unsigned long)period_us);
}

void board_feed_watchdog(void) { WDOG3_CNT = WATCHDOG_REFRESH; }

void setup() {
    start_amplifier();
    pinMode(PWM_PIN, OUTPUT);
    analogWriteResolution(DRIVE_BITS);
    analogWriteFrequency(PWM_PIN, PWM_FREQUENCY);
    analogReadResolution(ANALOGUE_BITS);
    analogReadAveraging(1); /* four by default: too long for the interrupt */
    start_encoder(&arm, ARM_A, ARM_B, arm_edge);
    if (PENDULUM_IS_ENCODER) {
        start_encoder(&pendulum, PENDULUM_A, PENDULUM_B, pendulum_edge);
    }
    Serial.begin(1000000); /* over USB the rate has no meaning */
    furuta_setup();
    start_watchdog();
    digitalWrite(ENABLE_PIN, HIGH);
}
