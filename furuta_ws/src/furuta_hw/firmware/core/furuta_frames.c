#include "furuta_frames.h"

#define CRC_START 0xffffffffu
/* The CRC-32 over bytes and over their own CRC has this value, before the last inversion. */
#define CRC_RESIDUE 0xdebb20e3u
#define CRC_SIZE 4u

/* CRC-32 (IEEE 802.3, reflected) by half bytes: a table of 64 bytes instead of 1024. */
static uint32_t crc_add(uint32_t crc, uint8_t byte) {
    static const uint32_t table[16] = {
        0x00000000u, 0x1db71064u, 0x3b6e20c8u, 0x26d930acu, 0x76dc4190u, 0x6b6b51f4u,
        0x4db26158u, 0x5005713cu, 0xedb88320u, 0xf00f9344u, 0xd6d6a3e8u, 0xcb61b38cu,
        0x9b64c2b0u, 0x86d3d2d4u, 0xa00ae278u, 0xbdbdf21cu};
    crc = (crc >> 4) ^ table[(crc ^ byte) & 15u];
    return (crc >> 4) ^ table[(crc ^ ((uint32_t)byte >> 4)) & 15u];
}

/* COBS: replaces in place each length by the zero that it stands for. Returns the length of the
   payload, which then begins at data[1]; 0 if the last run goes beyond the end. */
static uint8_t unstuff(uint8_t *data, uint8_t length) {
    uint8_t at = 0;
    while (at < length) {
        const uint8_t run = data[at];
        data[at] = 0;
        if (run > length - at) {
            return 0;
        }
        at = (uint8_t)(at + run);
    }
    return (uint8_t)(length - 1u);
}

static bool crc_is_right(const uint8_t *payload, uint8_t size) {
    uint32_t crc = CRC_START;
    for (uint8_t i = 0; i < size; i++) {
        crc = crc_add(crc, payload[i]);
    }
    return crc == CRC_RESIDUE;
}

static uint16_t u16(const uint8_t *at) { return (uint16_t)(at[0] | ((uint16_t)at[1] << 8)); }

static uint32_t u32(const uint8_t *at) { return u16(at) | ((uint32_t)u16(at + 2) << 16); }

/* Two's complement, without a conversion that C leaves to the implementation. */
static int16_t i16(const uint8_t *at) {
    const uint16_t value = u16(at);
    return value < 0x8000u ? (int16_t)value : (int16_t)(-(int32_t)(0xffffu - value) - 1);
}

/* Takes the fields from a body of type and fields; false if no frame of the host looks so. */
static bool parse(const uint8_t *body, uint8_t size, struct furuta_frame *frame) {
    frame->type = body[0];
    switch (body[0]) {
    case FURUTA_HELLO:
        frame->version = body[1];
        frame->session = u16(body + 2);
        frame->period_us = u32(body + 4);
        frame->watchdog = u16(body + 8);
        return size == 10u;
    case FURUTA_DRIVE:
        frame->session = u16(body + 1);
        frame->sample = u32(body + 3);
        frame->code = i16(body + 7);
        return size == 9u;
    case FURUTA_ARM:
        frame->session = u16(body + 1);
        frame->sample = u32(body + 3);
        return size == 7u;
    case FURUTA_STOP:
        frame->session = u16(body + 1);
        return size == 3u;
    default:
        return false;
    }
}

static bool decode(struct furuta_reader *reader, struct furuta_frame *frame) {
    const uint8_t size = unstuff(reader->data, reader->length);
    const uint8_t *payload = reader->data + 1;
    if (size <= CRC_SIZE || !crc_is_right(payload, size)) {
        return false;
    }
    return parse(payload, (uint8_t)(size - CRC_SIZE), frame);
}

static enum furuta_found end_frame(struct furuta_reader *reader, struct furuta_frame *frame) {
    enum furuta_found found = FURUTA_NOTHING;
    if (reader->overlong) {
        reader->overlong = false; /* counted when it became too long */
    } else if (reader->length > 0) {
        found = decode(reader, frame) ? FURUTA_FRAME : FURUTA_INVALID;
    }
    reader->length = 0;
    return found;
}

enum furuta_found furuta_read(struct furuta_reader *reader, uint8_t byte,
                              struct furuta_frame *frame) {
    if (byte == 0) {
        return end_frame(reader, frame);
    }
    if (reader->overlong) {
        return FURUTA_NOTHING;
    }
    if (reader->length == FURUTA_LONGEST_FRAME) {
        reader->overlong = true;
        return FURUTA_INVALID;
    }
    reader->data[reader->length++] = byte;
    return FURUTA_NOTHING;
}

/* Writes a frame: COBS and CRC as the bytes come. */
struct writer {
    uint8_t *out;
    uint32_t crc;
    uint8_t length;
    uint8_t run; /* where the length of the present run belongs */
};

static void put_stuffed(struct writer *writer, uint8_t byte) {
    if (byte != 0) {
        writer->out[writer->length++] = byte;
        return;
    }
    writer->out[writer->run] = (uint8_t)(writer->length - writer->run);
    writer->run = writer->length++;
}

static void put_u8(struct writer *writer, uint8_t byte) {
    writer->crc = crc_add(writer->crc, byte);
    put_stuffed(writer, byte);
}

static void put_u16(struct writer *writer, uint16_t value) {
    put_u8(writer, (uint8_t)(value & 0xffu));
    put_u8(writer, (uint8_t)(value >> 8));
}

static void put_u32(struct writer *writer, uint32_t value) {
    put_u16(writer, (uint16_t)(value & 0xffffu));
    put_u16(writer, (uint16_t)(value >> 16));
}

static struct writer begin(uint8_t *out, enum furuta_type type) {
    struct writer writer = {out, CRC_START, 1, 0};
    put_u8(&writer, (uint8_t)type);
    return writer;
}

static uint8_t end(struct writer *writer) {
    uint32_t crc = ~writer->crc;
    for (uint8_t i = 0; i < CRC_SIZE; i++) {
        put_stuffed(writer, (uint8_t)(crc & 0xffu));
        crc >>= 8;
    }
    put_stuffed(writer, 0);
    writer->out[writer->run] = 0;
    return writer->length;
}

uint8_t furuta_encode_welcome(uint8_t out[FURUTA_LONGEST_ANSWER], uint16_t session,
                              uint32_t period_us, uint16_t watchdog) {
    struct writer writer = begin(out, FURUTA_WELCOME);
    put_u8(&writer, FURUTA_VERSION);
    put_u16(&writer, session);
    put_u32(&writer, period_us);
    put_u16(&writer, watchdog);
    return end(&writer);
}

uint8_t furuta_encode_sensors(uint8_t out[FURUTA_LONGEST_ANSWER],
                              const struct furuta_sample *sample) {
    struct writer writer = begin(out, FURUTA_SENSORS);
    put_u16(&writer, sample->session);
    put_u32(&writer, sample->number);
    put_u8(&writer, sample->status);
    put_u32(&writer, sample->answered);
    put_u16(&writer, sample->discarded);
    put_u32(&writer, (uint32_t)sample->arm);
    put_u16(&writer, (uint16_t)sample->speed);
    put_u32(&writer, (uint32_t)sample->pendulum);
    put_u16(&writer, (uint16_t)sample->drive);
    return end(&writer);
}
