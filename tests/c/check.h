/* A check that says where it failed, and tests: each runs before main, in the order of the file.
 * A program with arguments defines OWN_MAIN. */
#ifndef CHECK_H
#define CHECK_H

#include <stdio.h>

static int failed;

#define CHECK(condition)                                                                           \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition);                        \
            failed = 1;                                                                            \
        }                                                                                          \
    } while (0)

#ifndef OWN_MAIN
static int ran;

#define TEST(name)                                                                                 \
    static void name(void);                                                                        \
    __attribute__((constructor)) static void run_##name(void)                                      \
    {                                                                                              \
        ran++;                                                                                     \
        name();                                                                                    \
    }                                                                                              \
    static void name(void)

int main(void)
{
    return failed || ran == 0; /* no test is no success */
}
#endif

#endif
