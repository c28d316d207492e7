/* What the sketches of all Arduino boards share. A sketch includes it once, after its constants
   ARM_A, ARM_B, DIRECTION_PIN, ENABLE_PIN, FAULT_PIN and FAULT_LEVEL. */
#ifndef FURUTA_ARDUINO_H
#define FURUTA_ARDUINO_H

#include "furuta_encoder.h"
#include "furuta_firmware.h"

static volatile struct furuta_encoder arm;

static void arm_edge() { furuta_encoder_move(&arm, digitalRead(ARM_A), digitalRead(ARM_B)); }

static void start_encoder(volatile struct furuta_encoder *encoder, uint8_t a, uint8_t b,
                          void (*edge)()) {
    pinMode(a, INPUT_PULLUP);
    pinMode(b, INPUT_PULLUP);
    edge();
    encoder->count = 0;
    attachInterrupt(digitalPinToInterrupt(a), edge, CHANGE);
    attachInterrupt(digitalPinToInterrupt(b), edge, CHANGE);
}

/* The amplifier stays off until the end of the setup. */
static void start_amplifier() {
    pinMode(ENABLE_PIN, OUTPUT);
    digitalWrite(ENABLE_PIN, LOW);
    pinMode(DIRECTION_PIN, OUTPUT);
    pinMode(FAULT_PIN, INPUT_PULLUP);
}

int board_read(void) { return Serial.read(); }

int16_t board_speed(void) { return 0; }

bool board_fault(void) { return digitalRead(FAULT_PIN) == FAULT_LEVEL; }

void board_lock(void) { noInterrupts(); }

void board_unlock(void) { interrupts(); }

void loop() { furuta_poll(); }

#endif
