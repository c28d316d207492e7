/* The rules of a rig: session, samples, watchdog, drive. "What firmware must do" in
   docs/hardware.md, as pure functions on one structure. */
#ifndef FURUTA_RIG_H
#define FURUTA_RIG_H

#include "furuta_frames.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Bits of the status. */
#define FURUTA_ARMED 1u
#define FURUTA_WATCHDOG 2u
#define FURUTA_FAULT 4u

/* What a board can do. A period or watchdog beyond its limits is replaced by the nearest one. */
struct furuta_limits {
    uint32_t shortest_period_us;
    uint32_t longest_period_us;
    uint16_t longest_watchdog; /* [samples] */
    int16_t lowest_code;
    int16_t highest_code;
    int16_t zero_code; /* 0 V */
};

struct furuta_rig {
    struct furuta_limits limits;
    uint32_t period_us;
    uint32_t number;   /* of the newest sample */
    uint32_t answered; /* sample of the newest Drive frame that was applied */
    uint32_t driven;   /* Drive frames applied since power-on */
    uint16_t session;
    uint16_t watchdog;  /* [samples] */
    uint16_t discarded; /* frames, since Hello */
    int16_t code;       /* that the drive holds */
    uint8_t status;
    bool in_session;
    bool fault; /* of the rig: amplifier, emergency stop */
};

/* The state at power-on: no session, 0 V. */
void furuta_start(struct furuta_rig *rig, const struct furuta_limits *limits);

/* Begins a sample: counts it, and goes to 0 V if the host is silent or `rig->fault` is set. */
void furuta_advance(struct furuta_rig *rig);

/* Executes a frame of the host; false if it is discarded. */
bool furuta_execute(struct furuta_rig *rig, const struct furuta_frame *frame);

#ifdef __cplusplus
}
#endif

#endif
