static @real@ smaller(@real@ a, @real@ b) {
    return b < a ? b : a;
}

static @real@ larger(@real@ a, @real@ b) {
    return b > a ? b : a;
}

static @real@ sign(@real@ a) {
    return a > 0 ? 1 : a < 0 ? -1 : a;
}

static @bits@ bits_of(@real@ a) {
    const union {
        @real@ number;
        @bits@ digits;
    } both = {.number = a};
    return both.digits;
}

static @real@ real_of(@bits@ a) {
    const union {
        @bits@ digits;
        @real@ number;
    } both = {.digits = a};
    return both.number;
}

static int64_t remainder_of(int64_t a, int64_t b) {
    const int64_t rest = a % b;
    return rest != 0 && (rest < 0) != (b < 0) ? rest + b : rest;
}
