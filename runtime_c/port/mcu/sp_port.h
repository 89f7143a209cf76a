/* A board, as the firmware and the rest of the port see it. Three parts that never meet otherwise:
 *
 *     sp_firmware.c   the protocol and the scene      calls sp_port_*, sp_hand_*
 *     sp_port.c       bytes and periods               called by both, below
 *     sp_board_*.c    registers and interrupts        implements sp_board_*
 *
 * sp_transducer.c is the sensor and the motor: replace it by your own.
 */
#ifndef SP_PORT_H
#define SP_PORT_H

#include <stdint.h>

enum { SP_PORT_BAUD = 921600 };

/* For the main loop. */

/* UART on, interrupts on; a period of the timer is period_s. */
void sp_port_start(float period_s);

/* 0 where no byte waits. */
int sp_port_read(uint8_t *byte);

/* All n bytes or, where the line does not keep up, none: the receiver sees the gap. Never waits. */
void sp_port_write(const uint8_t *bytes, uint32_t n);

/* Periods that have passed since the last call. */
uint32_t sp_port_periods(void);

/* Until a byte or a period comes; returns at once where one has come. */
void sp_port_sleep(void);

/* Bytes that came and found no room, or that the UART itself lost. */
uint32_t sp_port_overflow(void);

/* For interrupts of the board. */
void sp_port_received(uint8_t byte);
void sp_port_lost(void);
void sp_port_period(void);

/* The next byte to send, 0 where there is none. */
int sp_port_next(uint8_t *byte);

/* Of the board. */
void sp_board_start(float period_s);

/* There are bytes to send: begin. Called with interrupts held back. */
void sp_board_send(void);

/* Of the hand: 1 and the newest motion (m, m/s) where the sensor has one, else 0; force (N) to the
 * motor. A board without a sensor is fed by the host. */
int sp_hand_motion(float *position_m, float *velocity_mps);
void sp_hand_force(float force_n);

#endif
