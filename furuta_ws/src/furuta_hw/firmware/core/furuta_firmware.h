/* The firmware on a board: call furuta_setup once, furuta_poll again and again, and furuta_tick
   from the timer's interrupt. */
#ifndef FURUTA_FIRMWARE_H
#define FURUTA_FIRMWARE_H

#include "furuta_board.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Sets 0 V and starts the timer. The board's pins must be ready. */
void furuta_setup(void);

/* Sends the newest sample, and takes one byte from the line. */
void furuta_poll(void);

/* Takes a sample: watchdog, drive, sensors. The only function for the interrupt. */
void furuta_tick(void);

/* The state of the rig, for tests. */
struct furuta_rig *furuta_state(void);

#ifdef __cplusplus
}
#endif

#endif
