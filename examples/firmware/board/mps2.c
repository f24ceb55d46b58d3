/* mps2 - start-up, text and time of an Arm MPS2 board with a Cortex-M4 (AN386) or Cortex-M7 (AN500), bare metal.
   qemu-system-arm -machine mps2-an386 -semihosting-config enable=on,target=native -icount shift=8 -kernel image:
   text goes out by semihosting (a debugger's service), and an instruction takes 256 ns of the board's time, so that its
   25 MHz timer counts instructions. On a real board it counts clock cycles / 6.4. */
#include "board.h"

extern uint32_t data_start[], data_end[], data_load[], bss_start[], bss_end[], stack_low[], stack_top[];
int main(void);
void board_reset(void);

#define REGISTER(address) (*(volatile uint32_t *)(address))
#define SYSTICK_CONTROL REGISTER(0xE000E010u)
#define SYSTICK_RELOAD REGISTER(0xE000E014u)
#define SYSTICK_VALUE REGISTER(0xE000E018u)
#define FPU_ACCESS REGISTER(0xE000ED88u)
#define SYSTICK_MASK 0xFFFFFFu
#define STACK_MARK 0x5A5A5A5Au

enum { SEMIHOSTING_WRITE = 0x04, SEMIHOSTING_EXIT = 0x20, EXIT_APPLICATION = 0x20026 };

static int32_t semihosting(int32_t operation, const void *argument)
{
  register int32_t r0 __asm__("r0") = operation;
  register const void *r1 __asm__("r1") = argument;
  __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

void board_print(const char *text)
{
  semihosting(SEMIHOSTING_WRITE, text);
}

static uint32_t started; /* SysTick counts down */

void board_count_start(void)
{
  started = SYSTICK_VALUE;
}

uint32_t board_count(void)
{
  const uint32_t ticks = (started - SYSTICK_VALUE) & SYSTICK_MASK;
  return (5u * ticks + 16u) / 32u; /* 6.4 ticks an instruction */
}

uint32_t board_stack(void)
{
  const uint32_t *at = stack_low;
  while (at < stack_top && *at == STACK_MARK) {
    at++;
  }
  return (uint32_t)((uintptr_t)stack_top - (uintptr_t)at);
}

static void leave(int32_t code)
{
  const int32_t reason[2] = {EXIT_APPLICATION, code};
  semihosting(SEMIHOSTING_EXIT, reason);
  for (;;) {
  }
}

/* A fault is told, and ends the program. */
static void fault(void)
{
  board_print("fault\n");
  leave(70);
}

void board_reset(void)
{
  uint32_t *stack;
  FPU_ACCESS |= 0xFu << 20;
  __asm__ volatile("dsb\n isb" ::: "memory");
  for (uint32_t *to = data_start, *from = data_load; to < data_end;) {
    *to++ = *from++;
  }
  for (uint32_t *to = bss_start; to < bss_end;) {
    *to++ = 0;
  }
  __asm__ volatile("mov %0, sp" : "=r"(stack));
  for (volatile uint32_t *to = stack_low; to < stack - 16; to++) {
    *to = STACK_MARK;
  }
  SYSTICK_RELOAD = SYSTICK_MASK;
  SYSTICK_VALUE = 0;
  SYSTICK_CONTROL = 5u; /* processor clock, on, no interrupt */
  leave(main());
}

typedef union vector {
  const void *address;
  void (*handler)(void);
} vector;

__attribute__((section(".vectors"), used)) static const vector vectors[16] = {
    {stack_top},        {.handler = board_reset}, {.handler = fault}, {.handler = fault},
    {.handler = fault}, {.handler = fault},       {.handler = fault}, {.handler = fault},
    {.handler = fault}, {.handler = fault},       {.handler = fault}, {.handler = fault},
    {.handler = fault}, {.handler = fault},       {.handler = fault}, {.handler = fault}};
