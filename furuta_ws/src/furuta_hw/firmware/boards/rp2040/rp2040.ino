/* Raspberry Pi Pico (RP2040), Arduino core of E. F. Philhower: two encoders or an encoder and an
   analogue sensor, an H-bridge. docs/firmware.md has the wiring. Compiled against stand-in headers
   only: not yet tried on a real board. */

#include <hardware/adc.h>
#include <hardware/irq.h>
#include <hardware/pwm.h>
#include <hardware/watchdog.h>
#include <pico/time.h>

/* Your rig. */
static const bool PENDULUM_IS_ENCODER = true; /* false: a potentiometer or Hall sensor */
static const int FAULT_LEVEL = HIGH;          /* of the fault input; HIGH if it is open */

static const uint8_t ARM_A = 2, ARM_B = 3;
static const uint8_t PENDULUM_A = 4, PENDULUM_B = 5;
static const uint8_t PENDULUM_ANALOGUE = 26, ANALOGUE_INPUT = 0;
static const uint8_t PWM_PIN = 6, DIRECTION_PIN = 7, ENABLE_PIN = 8, FAULT_PIN = 9;

static const uint16_t DRIVE_TOP = 2047; /* and the sign: codes of 12 bits */
static const uint32_t PWM_FREQUENCY = 20000;
static const int32_t ANALOGUE_HALF = 2048; /* 12 bits */
static const uint32_t WATCHDOG_MS = 100;

#include <furuta_arduino.h>

static volatile struct furuta_encoder pendulum;
static repeating_timer_t timer;

static void pendulum_edge() {
    furuta_encoder_move(&pendulum, digitalRead(PENDULUM_A), digitalRead(PENDULUM_B));
}

static void start_drive() {
    const uint32_t slice = pwm_gpio_to_slice_num(PWM_PIN);
    gpio_set_function(PWM_PIN, GPIO_FUNC_PWM);
    pwm_set_wrap(slice, DRIVE_TOP);
    pwm_set_clkdiv_int_frac(slice, (uint8_t)(F_CPU / (PWM_FREQUENCY * (DRIVE_TOP + 1u))), 0);
    pwm_set_gpio_level(PWM_PIN, 0);
    pwm_set_enabled(slice, true);
}

static bool on_timer(repeating_timer_t *) {
    furuta_tick();
    return true;
}

struct furuta_limits board_limits(void) {
    struct furuta_limits limits;
    limits.shortest_period_us = 500;
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
    }
}

int32_t board_arm(void) { return arm.count; }

int32_t board_pendulum(void) {
    return PENDULUM_IS_ENCODER ? pendulum.count : (int32_t)adc_read() - ANALOGUE_HALF;
}

void board_drive(int16_t code) {
    digitalWrite(DIRECTION_PIN, code < 0 ? LOW : HIGH);
    pwm_set_gpio_level(PWM_PIN, (uint16_t)(code < 0 ? -code : code));
}

void board_start_timer(uint32_t period_us) {
    static bool started = false;
    if (started) {
        cancel_repeating_timer(&timer);
    }
    /* Negative: from start to start, so that the period is exact. */
    started = add_repeating_timer_us(-(int64_t)period_us, on_timer, nullptr, &timer);
}

void board_feed_watchdog(void) { watchdog_update(); }

void setup() {
    start_amplifier();
    start_drive();
    start_encoder(&arm, ARM_A, ARM_B, arm_edge);
    if (PENDULUM_IS_ENCODER) {
        start_encoder(&pendulum, PENDULUM_A, PENDULUM_B, pendulum_edge);
    } else {
        adc_init();
        adc_gpio_init(PENDULUM_ANALOGUE);
        adc_select_input(ANALOGUE_INPUT);
    }
    irq_set_priority(IO_IRQ_BANK0, PICO_HIGHEST_IRQ_PRIORITY); /* encoders interrupt the timer */
    Serial.begin(1000000); /* over USB the rate has no meaning */
    furuta_setup();
    watchdog_enable(WATCHDOG_MS, true);
    digitalWrite(ENABLE_PIN, HIGH);
}
