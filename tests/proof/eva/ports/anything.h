/* Inputs of any value, for every driver of a port. */
#ifndef ANYTHING_H
#define ANYTHING_H

#include <stdint.h>

#include "__fc_builtin.h"

#define ANY(type, name)                                                                            \
    type name;                                                                                     \
    Frama_C_make_unknown((char *)&name, sizeof name)

#endif
