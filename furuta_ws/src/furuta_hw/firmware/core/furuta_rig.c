#include "furuta_rig.h"

#define DEFAULT_PERIOD_US 1000u

static void disarm(struct furuta_rig *rig) {
    rig->code = rig->limits.zero_code;
    rig->status &= (uint8_t)~FURUTA_ARMED;
}

static uint32_t supported_period(const struct furuta_limits *limits, uint32_t period_us) {
    if (period_us < limits->shortest_period_us) {
        return limits->shortest_period_us;
    }
    return period_us > limits->longest_period_us ? limits->longest_period_us : period_us;
}

void furuta_start(struct furuta_rig *rig, const struct furuta_limits *limits) {
    rig->limits = *limits;
    rig->period_us = supported_period(limits, DEFAULT_PERIOD_US);
    rig->number = 0;
    rig->answered = 0;
    rig->driven = 0;
    rig->session = 0;
    rig->watchdog = 0;
    rig->discarded = 0;
    rig->code = limits->zero_code;
    rig->status = 0;
    rig->in_session = false;
    rig->fault = false;
}

void furuta_advance(struct furuta_rig *rig) {
    rig->number++;
    if ((rig->status & FURUTA_ARMED) != 0 && rig->number - rig->answered >= rig->watchdog) {
        disarm(rig);
        rig->status |= FURUTA_WATCHDOG;
    }
    rig->status &= (uint8_t)~FURUTA_FAULT;
    if (rig->fault) {
        disarm(rig);
        rig->status |= FURUTA_FAULT;
    }
}

static bool start_session(struct furuta_rig *rig, const struct furuta_frame *hello) {
    const struct furuta_limits *limits = &rig->limits;
    disarm(rig);
    rig->status = 0;
    rig->discarded = 0;
    rig->number = 0;
    rig->answered = 0;
    rig->in_session = hello->version == FURUTA_VERSION;
    rig->session = hello->session;
    rig->period_us = supported_period(limits, hello->period_us);
    rig->watchdog = hello->watchdog;
    if (rig->watchdog > limits->longest_watchdog) {
        rig->watchdog = limits->longest_watchdog;
    }
    return true;
}

/* Whether a frame answers a sample within the watchdog's time. */
static bool is_fresh(const struct furuta_rig *rig, uint32_t sample) {
    return rig->number - sample < rig->watchdog;
}

/* Whether a sample number comes after another, across the wrap-around. */
static bool is_newer(uint32_t sample, uint32_t than) {
    const uint32_t ahead = sample - than;
    return 0 < ahead && ahead < 0x80000000u;
}

static bool arm(struct furuta_rig *rig, const struct furuta_frame *frame) {
    if (rig->fault || !is_fresh(rig, frame->sample)) {
        return false;
    }
    rig->status = FURUTA_ARMED;
    rig->answered = frame->sample;
    rig->code = rig->limits.zero_code;
    return true;
}

static bool drive(struct furuta_rig *rig, const struct furuta_frame *frame) {
    const struct furuta_limits *limits = &rig->limits;
    if ((rig->status & FURUTA_ARMED) == 0 || !is_fresh(rig, frame->sample) ||
        is_newer(rig->answered, frame->sample) || frame->code < limits->lowest_code ||
        frame->code > limits->highest_code) {
        return false;
    }
    rig->answered = frame->sample;
    rig->code = frame->code;
    rig->driven++;
    return true;
}

bool furuta_execute(struct furuta_rig *rig, const struct furuta_frame *frame) {
    if (frame->type == FURUTA_HELLO) {
        return start_session(rig, frame);
    }
    if (!rig->in_session || frame->session != rig->session) {
        return false;
    }
    switch (frame->type) {
    case FURUTA_STOP:
        disarm(rig);
        return true;
    case FURUTA_ARM:
        return arm(rig, frame);
    case FURUTA_DRIVE:
        return drive(rig, frame);
    default:
        return false;
    }
}
