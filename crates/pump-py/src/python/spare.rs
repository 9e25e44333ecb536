//! Memory for the small allocations of a program that has used up all of its own.
//!
//! Whatever grows with an input is reserved before it is used (`memory.rs`). A text, a table of a pump or a message is
//! not, and where it finds no room Rust ends the process, and with it a bench that moves a motor. So this module keeps
//! a reserve, from which such allocations are served when the system has nothing left. The next call then raises a
//! `MemoryError`, unless the reserve can be filled again.

use std::alloc::{GlobalAlloc, Layout, System};
use std::hint::black_box;
use std::ptr::null_mut;
use std::sync::atomic::{AtomicPtr, Ordering};

use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;

/// Size of the reserve, bytes. It takes room among addresses and no memory, as nothing is written to it.
const RESERVE: Layout = match Layout::from_size_align(4 << 20, 16) {
    Ok(layout) => layout,
    Err(_) => panic!("the size of the reserve is no size"),
};
/// Largest allocation that the reserve serves, bytes. A larger one grows with an input.
const LARGEST: usize = 256 << 10;
/// Room for a thread, bytes: the stack that Rust gives it, and half as much.
const THREAD: usize = 3 << 20;

/// Block that is given back when the system has nothing left; null after that.
static BLOCK: AtomicPtr<u8> = AtomicPtr::new(null_mut());

/// The system's allocator with a reserve.
struct Reserving;

#[global_allocator]
static ALLOCATOR: Reserving = Reserving;

/// Gives the reserve back to the system. Returns false if there is none.
fn give_back() -> bool {
    let block = BLOCK.swap(null_mut(), Ordering::AcqRel);
    if block.is_null() {
        return false;
    }
    #[allow(
        unsafe_code,
        reason = "the block came from the same allocator by the same layout, and is taken out once"
    )]
    unsafe {
        System.dealloc(block, RESERVE);
    }
    true
}

/// Fills the reserve if it was given back.
///
/// # Errors
///
/// `MemoryError` if there is no room for it.
pub(crate) fn refill() -> PyResult<()> {
    if !BLOCK.load(Ordering::Acquire).is_null() {
        return Ok(());
    }
    #[allow(unsafe_code, reason = "the layout has a size other than zero")]
    let block = unsafe { System.alloc(RESERVE) };
    if block.is_null() {
        return Err(PyMemoryError::new_err(
            "the memory is used up, so that nothing new is begun; free some, and call again",
        ));
    }
    if BLOCK.compare_exchange(null_mut(), block, Ordering::AcqRel, Ordering::Acquire).is_err() {
        #[allow(unsafe_code, reason = "another thread was first, and nobody else has this block")]
        unsafe {
            System.dealloc(block, RESERVE);
        }
    }
    Ok(())
}

/// Looks for room for the stacks of `threads` threads and for what they need to begin, and fills the reserve. A thread
/// that has a stack and no room beside it ends the process.
///
/// # Errors
///
/// `MemoryError` if there is no room.
pub(crate) fn room_for_threads(threads: usize) -> PyResult<()> {
    refill()?;
    let room = threads.checked_mul(THREAD).and_then(|size| Layout::from_size_align(size.max(1), 16).ok());
    #[allow(
        unsafe_code,
        reason = "the layout has a size other than zero, and the block is given back at once"
    )]
    let is_there = room.is_some_and(|room| unsafe {
        // A block that nobody looks at would not be asked for.
        let block = black_box(System.alloc(room));
        if !block.is_null() {
            System.dealloc(block, room);
        }
        !block.is_null()
    });
    if is_there {
        Ok(())
    } else {
        Err(PyMemoryError::new_err(format!("no memory for {threads} more threads")))
    }
}

#[allow(unsafe_code, reason = "every call is handed to the system's allocator as it came")]
unsafe impl GlobalAlloc for Reserving {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let block = unsafe { System.alloc(layout) };
        if block.is_null() && layout.size() <= LARGEST && give_back() {
            return unsafe { System.alloc(layout) };
        }
        block
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        unsafe { System.dealloc(block, layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        let block = unsafe { System.alloc_zeroed(layout) };
        if block.is_null() && layout.size() <= LARGEST && give_back() {
            return unsafe { System.alloc_zeroed(layout) };
        }
        block
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        let moved = unsafe { System.realloc(block, layout, size) };
        if moved.is_null() && size <= LARGEST && give_back() {
            return unsafe { System.realloc(block, layout, size) };
        }
        moved
    }
}
