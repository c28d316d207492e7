/* Every reachable state of the firmware's core, under every byte, tick and interrupt point.

   A breadth-first search over `struct state`, in which sample numbers are ages. For each state and
   input the compiled core itself takes the step, from several absolute sample numbers; the results
   must agree, obey the rules of docs/hardware.md (`tick` and `execute` below), and be safe. The
   core is compiled with hooks at every access to memory, which count them and note what both the
   main loop and the interrupt use.

   explore LONGEST_WATCHDOG WHOLE: the first in samples; with WHOLE = 1 frames come in one piece. */
#include <stdio.h>
#include <stdlib.h>

#include "core.h"
#include "frames.h"

#define LENGTH(array) ((int)(sizeof(array) / sizeof(array)[0]))
#define MOST_STATES (1u << 26)
#define MOST_ACCESSES 2000u

enum { BELOW = -101, LOW = -100, ZERO = -7, HIGH = 50, ABOVE = 51 };
static const int16_t codes[] = {ZERO, LOW, HIGH, BELOW, ABOVE, 1};
static const uint16_t sessions[] = {0, 0x1234};
static const uint32_t periods[] = {1000, 70000};
/* Absolute numbers of the newest sample, and what stands for an age beyond the watchdog. */
static const uint32_t bases[] = {1000, 0xffffffffu, 0x7fffffffu};
static uint32_t old_ages[LENGTH(bases)];
static int longest, whole;

/* Ages of samples are counted from the newest one, and are not told apart beyond `longest`. */
enum { ARMED = 1, TRIPPED = 2, FAULT = 4, NEXT_BUT_ONE = -2, GARBAGE = 1000, TOO_LONG = 2000 };
struct state {
    uint8_t in_session, session, watchdog, period, status, code, age, fault; /* the rig's */
    uint8_t ticked, unsent, sent_status, sent_code, sent_age, sent_drive;    /* newest sample */
    uint8_t asked, youngest; /* armed by the host; youngest sample that it has answered since */
    int8_t frame_age;        /* of the sample that the frame on the line answers */
    uint8_t got;             /* bytes of the frame so far */
    int16_t frame;           /* on the line: an index, GARBAGE or GARBAGE + 1, TOO_LONG */
};

/* What a call does to the outside. */
struct effects {
    uint8_t sensors, sensors_new, status, drive, age, session; /* sensors: 1 if sent */
    uint8_t welcome, timer, feeds;
    int8_t discards;
};

struct frame {
    uint8_t type, session, code, watchdog, period, version, size;
};
static struct frame frames[100];
static int frame_count;

/* ---- the rules, as docs/hardware.md states them ---- */

static struct state disarm(struct state s) {
    s.code = 0;
    s.status &= (uint8_t)~ARMED;
    return s;
}

static uint8_t older(uint8_t age) { return age < longest ? (uint8_t)(age + 1) : age; }

static struct state tick(struct state s, int fault) {
    s.sent_drive = s.code;
    s.age = older(s.age), s.youngest = older(s.youngest);
    s.frame_age = s.frame_age < longest ? (int8_t)(s.frame_age + 1) : s.frame_age;
    if (s.status & ARMED && s.age >= s.watchdog) {
        s = disarm(s);
        s.status |= TRIPPED;
    }
    s.status &= (uint8_t)~FAULT;
    if (fault) {
        s = disarm(s);
        s.status |= FAULT;
    }
    s.fault = (uint8_t)fault, s.ticked = 1, s.unsent = s.in_session;
    s.sent_status = s.status, s.sent_code = s.code, s.sent_age = s.age;
    if (fault || s.youngest >= s.watchdog) {
        s.asked = 0;
    }
    return s;
}

static struct state execute(struct state s, int fault, struct effects *out) {
    const struct frame f = frames[s.frame];
    const int fresh = 0 <= s.frame_age && s.frame_age < s.watchdog;
    const int ours = s.in_session && f.session == s.session;
    s.fault = (uint8_t)fault;
    if (f.type == FURUTA_HELLO) {
        s = disarm(s);
        s.in_session = f.version == FURUTA_VERSION, s.session = f.session;
        s.watchdog = (uint8_t)(f.watchdog < longest ? f.watchdog : longest);
        out->timer = (uint8_t)(s.period != f.period), s.period = f.period;
        s.status = s.age = s.unsent = s.asked = 0, s.youngest = (uint8_t)longest;
        out->welcome = 1, out->discards = -1; /* none since Hello */
    } else if (ours && f.type == FURUTA_STOP) {
        s = disarm(s);
        s.asked = 0;
    } else if (ours && f.type == FURUTA_ARM && fresh && !fault) {
        s = disarm(s);
        s.status = ARMED, s.age = (uint8_t)s.frame_age, s.asked = 1;
        s.youngest = s.age < s.youngest ? s.age : s.youngest;
    } else if (ours && f.type == FURUTA_DRIVE && fresh && s.status & ARMED &&
               s.frame_age <= s.age && LOW <= codes[f.code] && codes[f.code] <= HIGH) {
        s.age = (uint8_t)s.frame_age, s.code = f.code;
        s.youngest = s.age < s.youngest ? s.age : s.youngest;
    } else {
        out->discards = 1;
    }
    return s;
}

/* ---- concrete states ---- */

static int16_t drive;
static int next_byte, fault_now, fault_at_tick;
static unsigned locks, in_call, in_tick, points, fire, accesses, most_accesses;
static struct effects effects;
static unsigned long runs, states;
static const char *problem;

static void fail(const char *what) { problem = problem ? problem : what; }

static uint32_t absolute(int age, int base) {
    return bases[base] - (age >= longest ? old_ages[base] : (uint32_t)age);
}

static int encode(const struct state *s, int base, uint8_t *out) {
    const struct frame f = frames[s->frame];
    const uint16_t session = sessions[f.session], watchdog = f.watchdog;
    const uint32_t sample = absolute(s->frame_age, base), period = periods[f.period];
    const bool hello = f.type == FURUTA_HELLO;
    uint8_t body[16] = {f.type};
    memcpy(body + (hello ? 2 : 1), &session, 2); /* this computer is little-endian */
    body[1] = hello ? f.version : body[1];
    memcpy(body + (hello ? 4 : 3), hello ? &period : &sample, 4);
    memcpy(body + (hello ? 8 : 7), hello ? (const void *)&watchdog : &codes[f.code], 2);
    return pack(body, f.size, out);
}

static void restore(const struct state *s, int base) {
    static uint8_t bytes[80];
    memset(bytes, s->frame == GARBAGE ? 1 : 0xff, sizeof bytes);
    if (s->frame < GARBAGE && s->got > 0) {
        encode(s, base, bytes);
    }
    const struct furuta_limits limits = {1, 100000, (uint16_t)longest, LOW, HIGH, ZERO};
    *core_rig = (struct furuta_rig){
        .limits = limits, .period_us = periods[s->period], .number = bases[base],
        .answered = absolute(s->age, base), .session = sessions[s->session],
        .watchdog = s->watchdog, .discarded = 5, .code = codes[s->code], .status = s->status,
        .in_session = s->in_session, .fault = s->fault};
    *core_newest = (struct furuta_sample){
        .number = bases[base], .answered = absolute(s->sent_age, base), .arm = 1,
        .session = core_rig->session, .discarded = 5, .drive = codes[s->sent_drive],
        .status = s->sent_status};
    *core_unsent = s->unsent, *core_ticked = s->ticked, drive = codes[s->code];
    memset(core_reader, 0, sizeof *core_reader);
    memcpy(core_reader->data, bytes, s->got);
    core_reader->length = s->got;
    core_reader->overlong = s->frame == TOO_LONG;
}

static uint8_t code_index(int16_t code) {
    for (uint8_t i = 0; i < LENGTH(codes); i++) {
        if (codes[i] == code) {
            return i;
        }
    }
    fail("a code that nobody sent");
    return 0;
}

static uint8_t age_of(uint32_t sample, uint32_t newest) {
    return (uint8_t)(newest - sample < (uint32_t)longest ? newest - sample : (uint32_t)longest);
}

/* The rig's part of a state, as it is in memory. */
static struct state observe(struct state s) {
    const struct furuta_rig *rig = core_rig;
    s.in_session = rig->in_session, s.session = rig->session == sessions[1];
    s.watchdog = (uint8_t)rig->watchdog, s.period = rig->period_us == periods[1];
    s.status = rig->status, s.code = code_index(rig->code), s.fault = rig->fault;
    s.age = age_of(rig->answered, rig->number), s.ticked = *core_ticked, s.unsent = *core_unsent;
    if (s.unsent) {
        const struct furuta_sample *sample = core_newest;
        s.sent_status = sample->status, s.sent_drive = code_index(sample->drive);
        s.sent_age = age_of(sample->answered, sample->number);
    }
    if (rig->session != sessions[s.session] || rig->period_us != periods[s.period]) {
        fail("a session or period that nobody sent");
    }
    if (drive != rig->code) {
        fail("the drive does not hold the rig's code");
    }
    return s;
}

/* ---- the board ---- */

static void interrupt(void) {
    const uint32_t before = core_rig->number;
    fault_now ^= fault_at_tick;
    in_tick = 1;
    furuta_tick();
    in_tick = 0;
    fault_now ^= fault_at_tick;
    if (core_rig->number != before + 1u) {
        fail("a tick is not one sample");
    }
}

static void count(void) {
    if (++accesses > MOST_ACCESSES) {
        puts("refuted: a loop without end");
        exit(1);
    }
}

/* The interrupt comes at calls of the board only: between two of them the main loop uses no memory
   that the interrupt writes, and writes none that it reads, which `note` checks. */
static void point(void) {
    count();
    if (in_call && !in_tick && locks == 0 && ++points == fire) {
        interrupt();
    }
}

/* Bytes of the rig's memory that both sides use, where the main loop does not hold the interrupt
   off: [interrupt reads, interrupt writes, loop reads, loop writes]. */
static bool used[4][sizeof(struct furuta_rig) + sizeof(struct furuta_sample) + 2];

static void note(const void *at, size_t size, int write) {
    const struct { const void *start; size_t size; } parts[] = {
        {core_rig, sizeof *core_rig}, {core_newest, sizeof *core_newest},
        {core_unsent, 1}, {core_ticked, 1}};
    size_t begin = 0;
    for (int i = 0; i < LENGTH(parts); begin += parts[i++].size) {
        const size_t offset = (size_t)((const char *)at - (const char *)parts[i].start);
        for (size_t k = 0; offset < parts[i].size && k < size; k++) {
            used[(in_tick ? 0 : 2) + write][begin + offset + k] = true;
        }
    }
}

static void touch(const void *at, size_t size, int write) {
    count();
    if (in_tick || (in_call && locks == 0)) {
        note(at, size, write);
    }
}

/* Called by the compiler's instrumentation (-fsanitize=thread), without its run-time. */
#define HOOKS(n) \
    void __tsan_read##n(void *at); \
    void __tsan_write##n(void *at); \
    void __tsan_unaligned_read##n(void *at); \
    void __tsan_unaligned_write##n(void *at); \
    void __tsan_read##n(void *at) { touch(at, n, 0); } \
    void __tsan_write##n(void *at) { touch(at, n, 1); } \
    void __tsan_unaligned_read##n(void *at) { touch(at, n, 0); } \
    void __tsan_unaligned_write##n(void *at) { touch(at, n, 1); }
HOOKS(1) HOOKS(2) HOOKS(4) HOOKS(8) HOOKS(16)
void __tsan_init(void);
void __tsan_func_entry(void *at);
void __tsan_func_exit(void);
void __tsan_read_range(void *at, size_t size);
void __tsan_write_range(void *at, size_t size);
void __tsan_init(void) {}
void __tsan_func_entry(void *at) { (void)at; }
void __tsan_func_exit(void) {}
void __tsan_read_range(void *at, size_t size) { touch(at, size, 0); }
void __tsan_write_range(void *at, size_t size) { touch(at, size, 1); }

struct furuta_limits board_limits(void) {
    return (struct furuta_limits){1, 100000, (uint16_t)longest, LOW, HIGH, ZERO};
}
int board_read(void) {
    point();
    return next_byte;
}
int32_t board_arm(void) { return 1; }
int16_t board_speed(void) { return 0; }
int32_t board_pendulum(void) { return 0; }
bool board_fault(void) { return fault_now; }
void board_drive(int16_t code) {
    drive = code;
    point();
}
void board_start_timer(uint32_t period_us) {
    effects.timer = period_us == core_rig->period_us;
    point();
}
void board_lock(void) {
    point();
    if (locks++ > 0 || in_tick) {
        fail("locked twice, or in the interrupt");
    }
}
void board_unlock(void) {
    if (locks-- != 1) {
        fail("unlocked twice");
    }
    point();
}
void board_feed_watchdog(void) {
    effects.feeds++;
    point();
}

void board_write(const uint8_t *data, uint8_t length) {
    uint8_t body[300];
    const int size = unpack(data, length - 1, body);
    if (locks > 0 || length > FURUTA_LONGEST_ANSWER || data[length - 1] != 0) {
        fail("a frame is sent while locked, too long or not closed");
    } else if (size == 10 && body[0] == FURUTA_WELCOME) {
        effects.welcome = body[1] == FURUTA_VERSION &&
                          number(body + 2, 2) == core_rig->session &&
                          number(body + 4, 4) == core_rig->period_us &&
                          number(body + 8, 2) == core_rig->watchdog;
    } else if (size == 26 && body[0] == FURUTA_SENSORS) {
        const uint32_t sample = number(body + 3, 4);
        effects.sensors = number(body + 14, 4) == 1;
        effects.sensors_new = (uint8_t)(sample - bases[0]);
        effects.session = number(body + 1, 2) == sessions[1];
        effects.status = body[7], effects.age = age_of(number(body + 8, 4), sample);
        effects.drive = code_index((int16_t)number(body + 24, 2));
    } else {
        fail("a frame that is none");
    }
    point();
}

/* ---- a step, and what is allowed ---- */

/* Effects of sending the newest sample. */
static struct state send(struct state s, struct effects *out, int ticks) {
    if (s.unsent) {
        out->sensors = 1, out->sensors_new = (uint8_t)ticks, out->session = s.session;
        out->status = s.sent_status, out->age = s.sent_age, out->drive = s.sent_drive;
    }
    s.unsent = 0;
    return s;
}

/* The rules for a call of furuta_poll with a tick before its `at`-th part, none if at = 4. */
static struct state expect(struct state s, int at, int fault, struct effects *out) {
    const struct frame none = {0};
    struct effects e = {0};
    const int tick_fault = fault ^ fault_at_tick, byte = next_byte;
    s = at == 0 ? tick(s, tick_fault) : s;
    s = send(s, &e, at == 0);
    s = at == 1 ? tick(s, tick_fault) : s;
    const bool end = byte == 0;
    if (s.frame == TOO_LONG) {
        s.frame = end ? 0 : TOO_LONG, s.got = end ? 0 : s.got;
    } else if (s.frame < GARBAGE && s.got > 0 && end) {
        uint8_t bytes[80];
        const bool complete = s.got + 1 == encode(&s, 0, bytes);
        if (complete && memcmp(&frames[s.frame], &none, sizeof none) != 0 &&
            frames[s.frame].type <= FURUTA_STOP && frames[s.frame].type > 0 &&
            frames[s.frame].size == (uint8_t[]){0, 10, 9, 7, 3}[frames[s.frame].type]) {
            s = execute(s, fault, &e);
        } else {
            e.discards = 1;
        }
        s.got = 0;
    } else if (end) {
        e.discards = s.got > 0;
        s.got = 0;
    } else if (byte > 0 && s.got == FURUTA_LONGEST_FRAME) {
        s.frame = TOO_LONG, e.discards = 1;
    } else if (byte > 0) {
        s.got++;
    }
    s = at == 2 ? tick(s, tick_fault) : s;
    e.feeds = s.ticked, s.ticked = 0;
    s = at == 3 ? tick(s, tick_fault) : s;
    *out = e;
    return s;
}

/* The same state for what cannot be told apart any more. */
static struct state canonical(struct state s) {
    if (!s.unsent) {
        s.sent_status = s.sent_code = s.sent_age = s.sent_drive = 0;
    }
    s.sent_code = 0;
    if (s.got == 0) {
        s.frame = 0, s.frame_age = 0;
    } else if (s.frame >= GARBAGE ||
               (frames[s.frame].type != FURUTA_DRIVE && frames[s.frame].type != FURUTA_ARM)) {
        s.frame_age = 0;
    }
    return s;
}

static bool same(struct state a, struct state b) {
    a = canonical(a), b = canonical(b);
    return memcmp(&a, &b, sizeof a) == 0;
}

static void safe(const struct state *s) {
    const int16_t code = codes[s->code];
    if (code < LOW || code > HIGH) {
        fail("a voltage beyond the limit");
    }
    if (code != ZERO && s->youngest >= s->watchdog) {
        fail("not 0 V within the watchdog");
    }
    if ((code != ZERO || s->status & ARMED) && !s->asked) {
        fail("armed unasked");
    }
}

/* ---- the search ---- */

static struct state *queue;
static uint32_t *slots, queued;

static void add(struct state s) {
    s = canonical(s);
    uint64_t hash = 14695981039346656037u;
    for (size_t i = 0; i < sizeof s; i++) {
        hash = (hash ^ ((const uint8_t *)&s)[i]) * 1099511628211u;
    }
    uint32_t slot = (uint32_t)(hash >> 32) % (2 * MOST_STATES);
    for (; slots[slot] != 0; slot = (slot + 1) % (2 * MOST_STATES)) {
        if (memcmp(&queue[slots[slot] - 1], &s, sizeof s) == 0) {
            return;
        }
    }
    if (queued == MOST_STATES) {
        puts("too many states");
        exit(2);
    }
    queue[queued] = s;
    slots[slot] = ++queued;
}

static void refute(const struct state *s) {
    printf("refuted: %s; session %d.%d watchdog %d status %d code %d age %d, frame %d.%d, byte %d, "
           "interrupt %u\n",
           problem, s->in_session, s->session, s->watchdog, s->status, codes[s->code], s->age,
           s->frame, s->got, next_byte, fire);
    exit(1);
}

/* Runs one call of the core from `s`: a tick, or a poll interrupted at point `fire` (0: not).
   Returns whether it was interrupted. */
static bool run(struct state s, bool poll, int fault, struct state after) {
    bool interrupted = false;
    struct state result = {0};
    for (int base = 0; base < LENGTH(bases); base++) {
        runs++;
        restore(&s, base);
        uint8_t bytes[80];
        if (after.got > s.got && after.frame < GARBAGE) {
            encode(&after, base, bytes);
            next_byte = bytes[s.got];
        }
        memset(&effects, 0, sizeof effects);
        fault_now = fault, points = accesses = locks = 0;
        effects.sensors_new = 0;
        if (poll) {
            in_call = 1;
            furuta_poll();
            in_call = 0;
            interrupted = fire > 0 && points >= fire;
        } else {
            interrupt();
        }
        most_accesses = accesses > most_accesses ? accesses : most_accesses;
        const int16_t discards = (int16_t)(core_rig->discarded - 5);
        effects.discards = (int8_t)(discards == -5 ? -1 : discards);
        if (effects.sensors) {
            effects.sensors_new =
                (uint8_t)(effects.sensors_new + bases[0] - bases[base]);
        }
        if (locks != 0) {
            fail("left locked");
        }
        bool allowed = false;
        for (int at = poll && interrupted ? 0 : 4; poll && at < (interrupted ? 4 : 5); at++) {
            struct effects out;
            struct state expected = expect(s, at, fault, &out);
            if (after.got > s.got && next_byte > 0) {
                expected.frame = expected.frame == TOO_LONG ? expected.frame : after.frame;
                expected.frame_age = (int8_t)(after.frame_age + (at < 4));
                expected.frame_age = expected.frame_age > longest ? (int8_t)longest
                                                                   : expected.frame_age;
            }
            struct state observed = observe(expected);
            observed.got = core_reader->length;
            if (same(observed, expected) && memcmp(&out, &effects, sizeof out) == 0 &&
                core_reader->overlong == (expected.frame == TOO_LONG)) {
                allowed = true;
                result = expected;
            }
        }
        if (!poll) {
            result = tick(s, fault ^ fault_at_tick);
            allowed = same(observe(result), result);
        }
        if (!allowed) {
            fail("against the rules");
        }
        struct state seen = observe(result);
        safe(&seen);
        if (problem) {
            refute(&s);
        }
    }
    add(result);
    return interrupted;
}

/* All interrupt points of a poll with this byte, after which the line holds `after`'s frame. */
static void poll(const struct state *s, int byte, struct state after) {
    for (int faults = 0; faults < 4; faults++) {
        next_byte = byte, fault_at_tick = faults >> 1, fire = 0;
        if (faults < 2) {
            run(*s, true, faults & 1, after);
        }
        for (fire = 1; run(*s, true, faults & 1, after); fire++) {
            next_byte = byte;
        }
    }
    fire = 0;
}

static void begin_frame(const struct state *s, int frame) {
    const bool numbered =
        frames[frame].type == FURUTA_DRIVE || frames[frame].type == FURUTA_ARM;
    for (int age = numbered ? NEXT_BUT_ONE : 0; age <= (numbered ? longest : 0); age++) {
        struct state after = *s;
        after.frame = (int16_t)frame, after.frame_age = (int8_t)age;
        if (whole) {
            uint8_t bytes[80];
            after.got = (uint8_t)(encode(&after, 0, bytes) - 1);
            add(after);
        } else {
            after.got = 1;
            poll(s, -2, after);
        }
    }
}

static void expand(struct state s) {
    for (fault_at_tick = 0; fault_at_tick < 2; fault_at_tick++) {
        run(s, false, 0, s);
    }
    poll(&s, -1, s);
    poll(&s, 0, s);
    if (s.got == 0) {
        for (int frame = 0; frame < frame_count; frame++) {
            begin_frame(&s, frame);
        }
    }
    if (whole) {
        return;
    }
    struct state after = s;
    after.got++;
    uint8_t bytes[80] = {0};
    if (s.got > 0 && s.frame < GARBAGE && s.got + 2 <= encode(&s, 0, bytes)) {
        poll(&s, -2, after);
    }
    for (int family = 0; family < 2; family++) {
        const int byte = family ? 0xff : 1;
        after.frame = (int16_t)(s.frame == TOO_LONG ? TOO_LONG : GARBAGE + family);
        if (s.got == 0 || s.frame == TOO_LONG || s.frame == GARBAGE + family ||
            (s.frame < GARBAGE && bytes[s.got] != byte)) {
            poll(&s, byte, after);
        }
    }
}

static void add_frame(struct frame frame) { frames[frame_count++] = frame; }

static void make_frames(void) {
    for (uint8_t session = 0; session < 2; session++) {
        for (int watchdog = whole ? longest - 1 : 0; watchdog <= longest + 1; watchdog++) {
            add_frame((struct frame){FURUTA_HELLO, session, 0, (uint8_t)watchdog, watchdog & 1, 1,
                                     10});
        }
        add_frame((struct frame){FURUTA_HELLO, session, 0, (uint8_t)longest, 0, 2, 10});
        for (uint8_t code = 0; code < LENGTH(codes); code++) {
            add_frame((struct frame){FURUTA_DRIVE, session, code, 0, 0, 0, 9});
        }
        add_frame((struct frame){FURUTA_ARM, session, 0, 0, 0, 0, 7});
        add_frame((struct frame){FURUTA_STOP, session, 0, 0, 0, 0, 3});
    }
    for (uint8_t type = 1; type <= 4; type++) { /* of another size than the type has */
        add_frame((struct frame){type, 0, 0, 0, 0, 1, 8});
    }
    add_frame((struct frame){5, 0, 0, 0, 0, 0, 3});
    add_frame((struct frame){FURUTA_SENSORS, 0, 0, 0, 0, 0, 9});
}

int main(int argc, char **argv) {
    if (argc != 3) {
        return 2;
    }
    longest = atoi(argv[1]), whole = atoi(argv[2]);
    const uint32_t old[] = {(uint32_t)longest, 0x80000000u, 0xfffffff0u};
    memcpy(old_ages, old, sizeof old);
    make_frames();
    queue = calloc(MOST_STATES, sizeof *queue);
    slots = calloc(2 * MOST_STATES, sizeof *slots);
    if (queue == NULL || slots == NULL) {
        return 2;
    }
    fault_now = 0;
    furuta_setup();
    struct state start = {.youngest = (uint8_t)longest};
    if (!same(observe(start), start) || core_reader->length != 0) {
        puts("refuted: power-on");
        return 1;
    }
    add(start);
    for (states = 0; states < queued; states++) {
        expand(queue[states]);
    }
    for (size_t i = 0; i < sizeof used[0]; i++) {
        if ((used[1][i] && (used[2][i] || used[3][i])) || (used[0][i] && used[3][i])) {
            printf("refuted: byte %zu is shared with the interrupt without a lock\n", i);
            return 1;
        }
    }
    printf("%lu states, %lu runs of the core, at most %u accesses to memory in a call\n", states,
           runs, most_accesses);
    return 0;
}
