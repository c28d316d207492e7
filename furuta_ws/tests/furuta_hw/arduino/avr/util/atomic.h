#define ATOMIC_RESTORESTATE 1
#define ATOMIC_BLOCK(kind) for (int once = kind; once != 0; once = 0)
