//! Measures the use of flash and RAM.

#![allow(unsafe_code, reason = "the stack is read as what it is: memory")]

unsafe extern "C" {
    // Places, not values: made by cortex-m-rt's linker script.
    static __sdata: u32;
    static __edata: u32;
    static __sidata: u32;
    static __sbss: u32;
    static __ebss: u32;
    static _stack_end: u32;
    static _stack_start: u32;
}

/// Returns the bytes of flash and of statics in RAM.
pub fn flash_and_statics() -> (usize, usize) {
    let data = (&raw const __edata).addr() - (&raw const __sdata).addr();
    let bss = (&raw const __ebss).addr() - (&raw const __sbss).addr();
    ((&raw const __sidata).addr() + data, data + bss)
}

/// Returns the bytes of the stack that were ever used. cortex-m-rt has painted the stack, and words that
/// are still painted were not used.
pub fn stack() -> usize {
    let bottom = &raw const _stack_end;
    let words = ((&raw const _stack_start).addr() - bottom.addr()) / 4;
    let is_painted = |n: &usize| {
        // SAFETY: within the stack's bounds by the linker script, aligned, and only read; volatile, because the
        // compiler knows nothing of these words.
        unsafe { bottom.add(*n).read_volatile() == cortex_m_rt::STACK_PAINT_VALUE }
    };
    4 * (words - (0..words).take_while(is_painted).count())
}
