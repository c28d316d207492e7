/* Frames by their definition in docs/hardware.md, bit by bit; shares no code with the firmware. */
#ifndef FRAMES_H
#define FRAMES_H

#include <stdint.h>
#include <string.h>

static uint32_t crc32(const uint8_t *data, int size) {
    uint32_t crc = 0xffffffffu;
    for (int i = 0; i < 8 * size; i++) {
        const uint32_t bit = (crc ^ (uint32_t)(data[i / 8] >> i % 8)) & 1u;
        crc = (crc >> 1) ^ (bit ? 0xedb88320u : 0u);
    }
    return ~crc;
}

static uint32_t number(const uint8_t *at, int bytes) {
    uint32_t value = 0;
    for (int i = 0; i < bytes; i++) {
        value |= (uint32_t)at[i] << 8 * i;
    }
    return value;
}

/* Encodes a body with its CRC and the closing zero; returns the length. */
static int pack(const uint8_t *body, int size, uint8_t *out) {
    const uint32_t crc = crc32(body, size);
    int run = 0, length = 1;
    for (int i = 0; i < size + 4; i++) {
        const uint8_t byte = i < size ? body[i] : (uint8_t)(crc >> 8 * (i - size));
        if (byte != 0) {
            out[length++] = byte;
        } else {
            out[run] = (uint8_t)(length - run);
            run = length++;
        }
    }
    out[run] = (uint8_t)(length - run);
    out[length] = 0;
    return length + 1;
}

/* Decodes a frame without its closing zero; returns the size of the body, -1 if it is no frame. */
static int unpack(const uint8_t *in, int length, uint8_t *body) {
    int size = 0;
    for (int i = 0; i < length;) {
        const int end = i + in[i];
        if (in[i] == 0 || end > length) {
            return -1;
        }
        for (i++; i < end; i++) {
            body[size++] = in[i];
        }
        if (end < length) {
            body[size++] = 0;
        }
    }
    size -= 4;
    return size < 1 || crc32(body, size) != number(body + size, 4) ? -1 : size;
}

#endif
