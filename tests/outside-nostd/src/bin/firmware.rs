//! The controller as a microcontroller gets it: one function that its timer calls.
#![no_std]
#![no_main]

use outside_nostd::{Cart, Controller, State};

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}

/// Where the linker begins: a board's start-up code would set its timer here, and call this at every tick.
#[unsafe(no_mangle)]
pub extern "C" fn _start() -> ! {
    let mut controller = Controller::<f32>::new(&Cart::default());
    // Volatile, as the registers of encoders and of the motor are: nothing of the loop is left out.
    let (mut measured, mut push) = ([0.0_f32; 6], 0.0_f32);
    loop {
        // SAFETY: both point to values on this function's stack.
        let [x, theta1, theta2, vx, w1, w2] = unsafe { core::ptr::read_volatile(&raw mut measured) };
        let state = State { q: [x, theta1, theta2], v: [vx, w1, w2] };
        let force = controller.tick(state).unwrap_or(0.0);
        // SAFETY: as above.
        unsafe { core::ptr::write_volatile(&raw mut push, force) };
    }
}
