/* What the compiler calls of a C library. */
void __aeabi_memclr8(unsigned char *to, unsigned long count);

void __aeabi_memclr8(unsigned char *to, unsigned long count) {
    for (volatile unsigned char *at = to; at < to + count; at++) {
        *at = 0;
    }
}
