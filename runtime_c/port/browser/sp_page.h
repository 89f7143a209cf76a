/* A scene in closed loop with a simulated hand, for a page in a browser. The page calls these
 * functions and reads and writes the arrays: one row a tick. */
#ifndef SP_PAGE_H
#define SP_PAGE_H

#include <stdint.h>

#include "sp_real.h"

enum { SP_PAGE_ROWS = 16384, SP_PAGE_MAX_DELAY = 176 };

extern double sp_page_intended_m[SP_PAGE_ROWS]; /* where the hand intends to be after the tick */
extern sp_real sp_page_position_m[SP_PAGE_ROWS];
extern sp_real sp_page_velocity_mps[SP_PAGE_ROWS];
extern sp_real sp_page_force_n[SP_PAGE_ROWS];
extern int32_t sp_page_notes[SP_PAGE_ROWS];

/* The device that the hand holds. */
void sp_page_set_device(double mass_kg, double viscous_nspm, double coulomb_n);

/* The hand, and how many samples late the force acts, at most SP_PAGE_MAX_DELAY. */
void sp_page_set_hand(double mass_kg, double stiffness_npm, double damping_nspm, uint32_t delay);

/* A fresh scene, and the hand at rest at position_m. */
void sp_page_start(double position_m);

/* `rows` ticks of dt_s towards sp_page_intended_m; fills the other arrays. */
void sp_page_run(uint32_t rows, double dt_s);

#endif
