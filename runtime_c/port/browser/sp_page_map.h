/* A scene with a map, for a page in a browser: beside sp_page.h, of which it shares the rows of
 * depth, force and notes. The tool has three axes. Off the object it is carried to where the hand
 * intends to be; on it, the place is held, or the tool slides, as the scene does (sp_page_touch.h).
 */
#ifndef SP_PAGE_MAP_H
#define SP_PAGE_MAP_H

#include <stdint.h>

#include "sp_real.h"

/* Buffers of a row each: where the hand intends to be, where the tool is, and the force on it. */
double *sp_page_map_intended_x_m(void);
double *sp_page_map_intended_y_m(void);
sp_real *sp_page_map_x_m(void);
sp_real *sp_page_map_y_m(void);
sp_real *sp_page_map_x_n(void);
sp_real *sp_page_map_y_n(void);

/* 1 if the tool slides on the object, 0 if the place is held. */
int sp_page_map_slides(void);

/* How fast the tool is carried off the object. */
double sp_page_map_carried_mps(void);

/* sp_page_device, sp_page_hold, sp_page_start and sp_page_press, of three axes. */
int sp_page_map_device(double mass_kg, double viscous_nspm, double coulomb_n);
int sp_page_map_hold(double mass_kg, double stiffness_npm, double damping_nspm,
                     uint32_t delay_samples);
void sp_page_map_start(double x_m, double y_m, double depth_m);
void sp_page_map_press(uint32_t rows, double dt_s);

/* sp_page_replay at a place. */
void sp_page_map_replay(uint32_t rows, double x_m, double y_m);

#endif
