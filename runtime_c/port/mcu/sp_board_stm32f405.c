/* STM32F405 (Cortex-M4F): USART1 on PA9 and PA10. The clocks are at their full speed when main
 * begins, as the vendor's SystemClock_Config leaves them (the emulator has no others). */
#include "sp_arm.h"
#include "sp_port.h"

#define RCC_AHB1ENR SP_REGISTER(0x40023830u)
#define RCC_APB2ENR SP_REGISTER(0x40023844u)
#define GPIOA_MODER SP_REGISTER(0x40020000u)
#define GPIOA_AFRH SP_REGISTER(0x40020024u)
#define USART_SR SP_REGISTER(0x40011000u)
#define USART_DR SP_REGISTER(0x40011004u)
#define USART_BRR SP_REGISTER(0x40011008u)
#define USART_CR1 SP_REGISTER(0x4001100cu)

enum {
    CORE_HZ = 168000000,
    USART_HZ = 84000000,
    AHB1_GPIOA = 1,
    APB2_USART1 = 1 << 4,
    MODER_PA9_PA10 = 0xa << 18, /* alternate function */
    AFRH_PA9_PA10 = 0x77 << 4,  /* USART1 */
    SR_LOST = 1 << 3,
    SR_RECEIVED = 1 << 5,
    SR_EMPTY = 1 << 7,
    CR1_ON = 1 << 13 | 1 << 5 | 1 << 3 | 1 << 2, /* on, interrupt on receipt, both ways */
    CR1_WHEN_EMPTY = 1 << 7,
    INTERRUPT_USART1 = 37
};

void sp_board_start(float period_s)
{
    RCC_AHB1ENR |= AHB1_GPIOA;
    RCC_APB2ENR |= APB2_USART1;
    GPIOA_MODER = (GPIOA_MODER & ~(0xfu << 18)) | MODER_PA9_PA10;
    GPIOA_AFRH = (GPIOA_AFRH & ~(0xffu << 4)) | AFRH_PA9_PA10;
    USART_BRR = (USART_HZ + SP_PORT_BAUD / 2) / SP_PORT_BAUD;
    USART_CR1 = CR1_ON;
    sp_arm_enable(INTERRUPT_USART1);
    sp_arm_periods((float)CORE_HZ, period_s);
}

void sp_board_send(void)
{
    uint8_t byte;
    while (USART_SR & SR_EMPTY) {
        if (!sp_port_next(&byte)) {
            USART_CR1 = CR1_ON;
            return;
        }
        USART_DR = byte;
    }
    USART_CR1 = CR1_ON | CR1_WHEN_EMPTY;
}

void sp_board_interrupt(uint32_t number)
{
    (void)number;
    for (uint32_t status; (status = USART_SR) & (SR_RECEIVED | SR_LOST);) {
        if (status & SR_LOST) {
            sp_port_lost();
        }
        sp_port_received((uint8_t)USART_DR); /* reading it clears both */
    }
    sp_board_send();
}
