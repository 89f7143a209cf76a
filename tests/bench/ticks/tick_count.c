/* Runs N ticks of a library's step function on positions of a file: callgrind counts them. */
#include <dlfcn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef int (*step_function)(void *, float, float, float *);
typedef void (*init_function)(void *);

int main(int argc, char **argv)
{
    /* library, step, init or "-", state bytes, positions, ticks */
    if (argc != 7) {
        return 2;
    }
    void *library = dlopen(argv[1], RTLD_NOW);
    FILE *file = fopen(argv[5], "rb");
    const long ticks = atol(argv[6]);
    if (library == NULL || file == NULL) {
        return 3;
    }
    void *found = dlsym(library, argv[2]);
    step_function step;
    memcpy(&step, &found, sizeof step);
    void *state = calloc(1, (size_t)atol(argv[4]) + 8);
    float *positions = calloc((size_t)ticks, sizeof(float));
    if (fread(positions, sizeof(float), (size_t)ticks, file) != (size_t)ticks) {
        return 4;
    }
    if (strcmp(argv[3], "-") != 0) {
        init_function init;
        found = dlsym(library, argv[3]);
        memcpy(&init, &found, sizeof init);
        init(state);
    }
    float force_n = 0, sum = 0;
    for (long i = 0; i < ticks; i++) {
        (void)step(state, positions[i], 0.0f, &force_n);
        sum += force_n;
    }
    printf("%a\n", (double)sum);
    return 0;
}
