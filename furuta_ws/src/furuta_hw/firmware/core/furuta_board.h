/* What a board provides to the firmware: twelve functions. docs/firmware.md says how to port. */
#ifndef FURUTA_BOARD_H
#define FURUTA_BOARD_H

#include "furuta_rig.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Limits of the board; called once, at power-on. For other periods the nearest one is offered. */
struct furuta_limits board_limits(void);

/* The serial line. board_read returns a received byte, or -1 if there is none. board_write sends
   the whole frame, or none of it if there is no room; it does not wait. */
int board_read(void);
void board_write(const uint8_t *data, uint8_t length);

/* The sensors' raw codes; 0 if there is no such sensor. Called in the interrupt: do not wait for a
   converter, do not print. */
int32_t board_arm(void);
int16_t board_speed(void);
int32_t board_pendulum(void);

/* Whether the rig has a fault: amplifier, emergency stop. */
bool board_fault(void);

/* Sets the drive at once. In reset the pins must hold 0 V. */
void board_drive(int16_t code);

/* Calls furuta_tick every period [us], within 0.02 %, from an interrupt; called again for another
   period. Encoder interrupts need a higher priority, or a counter in hardware. */
void board_start_timer(uint32_t period_us);

/* Hold off the timer's interrupt, for less than 200 instructions. The compiler must not move
   accesses to memory across these calls. */
void board_lock(void);
void board_unlock(void);

/* Restarts the hardware watchdog, which must set 0 V by a reset if this call stays out. */
void board_feed_watchdog(void);

#ifdef __cplusplus
}
#endif

#endif
