/* Arduino Uno or Nano (ATmega328P, 16 MHz) at 250 Hz or less: an encoder on the arm, an analogue
   sensor on the pendulum, an H-bridge. docs/firmware.md has the wiring. Compiled against stand-in
   headers only: not yet tried on a real board. */

#include <avr/interrupt.h>
#include <avr/wdt.h>
#include <util/atomic.h>

/* Your rig. */
static const uint8_t FAULT_LEVEL = HIGH; /* of the fault input; HIGH if it is open */

/* Given by the hardware: interrupts on pins 2 and 3, PWM of timer 2 on pin 11, A0. */
static const uint8_t ARM_A = 2, ARM_B = 3, PWM_PIN = 11;
static const uint8_t DIRECTION_PIN = 7, ENABLE_PIN = 8, FAULT_PIN = 12;

static const uint32_t BAUD = 500000; /* at 1 Mbit/s bytes could be lost during an interrupt */
static const int16_t DRIVE_TOP = 255; /* and the sign: codes of 9 bits */
static const int32_t ANALOGUE_HALF = 512; /* 10 bits */
static const uint32_t TIMER_TICKS_PER_US = F_CPU / 8u / 1000000u;

#include <furuta_arduino.h>

/* Encoder and serial line interrupt this function, which takes longer than a byte. */
ISR(TIMER1_COMPA_vect, ISR_NOBLOCK) { furuta_tick(); }

/* Timer 2: PWM of 31 kHz without a gap at 0. */
static void start_drive() {
    pinMode(PWM_PIN, OUTPUT);
    OCR2A = 0;
    TCCR2A = _BV(COM2A1) | _BV(WGM20);
    TCCR2B = _BV(CS20);
}

/* The converter runs without end, so that reading takes no time. */
static void start_converter() {
    ADMUX = _BV(REFS0);
    ADCSRB = 0;
    ADCSRA = _BV(ADEN) | _BV(ADSC) | _BV(ADATE) | _BV(ADPS2) | _BV(ADPS1) | _BV(ADPS0);
}

struct furuta_limits board_limits(void) {
    struct furuta_limits limits;
    limits.shortest_period_us = 4000;
    limits.longest_period_us = 20000;
    limits.longest_watchdog = 125;
    limits.lowest_code = -DRIVE_TOP - 1;
    limits.highest_code = DRIVE_TOP;
    limits.zero_code = 0;
    return limits;
}

void board_write(const uint8_t *data, uint8_t length) {
    if (Serial.availableForWrite() >= length) {
        Serial.write(data, length);
    }
}

int32_t board_arm(void) {
    int32_t count = 0;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { count = arm.count; }
    return count;
}

int32_t board_pendulum(void) { return (int32_t)ADC - ANALOGUE_HALF; }

void board_drive(int16_t code) {
    const int16_t size = code < 0 ? -code : code;
    digitalWrite(DIRECTION_PIN, code < 0 ? LOW : HIGH);
    OCR2A = (uint8_t)(size > DRIVE_TOP ? DRIVE_TOP : size);
}

/* Timer 1: counts half microseconds, and starts again at the period. */
void board_start_timer(uint32_t period_us) {
    TIMSK1 = 0;
    TCCR1A = 0;
    TCCR1B = _BV(WGM12) | _BV(CS11);
    OCR1A = (uint16_t)(period_us * TIMER_TICKS_PER_US - 1u);
    TCNT1 = 0;
    TIFR1 = _BV(OCF1A);
    TIMSK1 = _BV(OCIE1A);
}

void board_feed_watchdog(void) { wdt_reset(); }

void setup() {
    wdt_disable();
    start_amplifier();
    start_drive();
    start_converter();
    start_encoder(&arm, ARM_A, ARM_B, arm_edge);
    Serial.begin(BAUD);
    furuta_setup();
    wdt_enable(WDTO_120MS);
    digitalWrite(ENABLE_PIN, HIGH);
}
