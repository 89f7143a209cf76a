#ifndef SP_REAL_H
#define SP_REAL_H

/* The number type of the scene. Its twin in include/float is the other choice. */
typedef double sp_real;

#endif
