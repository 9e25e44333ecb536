//! Memory for the small allocations of a program that has used up all of its own.
//!
//! Whatever grows with an input is reserved before it is used (`memory.rs`). A text, a table of a pump or a message is
//! not, and where it finds no room Rust ends the process, and with it a bench that moves a motor. So this module keeps
//! a reserve, which serves such allocations of any thread when the system has nothing left. The next call then raises a
//! `MemoryError`, unless the reserve can be filled again.

mod heap;
mod pages;

use std::alloc::{GlobalAlloc, Layout, System};
use std::ptr::copy_nonoverlapping;

use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;

/// Room for a thread, bytes: the stack of 2 MiB that Rust gives it, and as much again. C's allocator has no arena for a
/// thread where addresses are short, and makes a page of each allocation.
const THREAD: usize = 4 << 20;

/// The system's allocator with a reserve.
struct Reserving;

#[global_allocator]
static ALLOCATOR: Reserving = Reserving;

/// Fills the reserve if something of it is in use.
///
/// # Errors
///
/// `MemoryError` if there is no room for it.
pub(crate) fn refill() -> PyResult<()> {
    if heap::refill() {
        return Ok(());
    }
    Err(PyMemoryError::new_err(
        "the memory is used up, so that nothing new is begun; free some, and call again",
    ))
}

/// Tells if there is room for `size` bytes more.
fn has_room(size: usize) -> bool {
    pages::take(size).is_some_and(|room| {
        #[allow(unsafe_code, reason = "nobody has heard of these addresses")]
        unsafe {
            pages::give_back(room, size);
        }
        true
    })
}

/// Looks for room for the stacks of `threads` threads and for what they need, and fills the reserve. A thread that has
/// a stack and no room beside it ends the process.
///
/// # Errors
///
/// `MemoryError` if there is no room.
pub(crate) fn room_for_threads(threads: usize) -> PyResult<()> {
    refill()?;
    if threads.checked_mul(THREAD).is_some_and(has_room) {
        return Ok(());
    }
    let mib = threads.saturating_mul(THREAD) >> 20;
    Err(PyMemoryError::new_err(format!(
        "no memory for {threads} more thread{}, which take {mib} MiB of addresses",
        if threads == 1 { "" } else { "s" }
    )))
}

/// Returns the largest number of threads, `most` at most, that there is room for, and fills the reserve.
///
/// # Errors
///
/// `MemoryError` if there is no room for one.
pub(crate) fn threads_with_room(most: usize) -> PyResult<usize> {
    let mut threads = most.max(1);
    while threads > 1 && room_for_threads(threads).is_err() {
        threads /= 2;
    }
    room_for_threads(threads)?;
    Ok(threads)
}

impl Reserving {
    /// Moves an allocation to where there is room for its new size. Null leaves it where it is.
    ///
    /// # Safety
    ///
    /// `block` is an allocation of `layout`, and `size` is not zero.
    #[allow(unsafe_code, reason = "the caller promises what the parts need")]
    unsafe fn moved(&self, block: *mut u8, layout: Layout, new: Layout) -> *mut u8 {
        unsafe {
            let moved = self.alloc(new);
            if !moved.is_null() {
                copy_nonoverlapping(block, moved, layout.size().min(new.size()));
                self.dealloc(block, layout);
            }
            moved
        }
    }
}

#[allow(unsafe_code, reason = "every call is handed to the system's allocator as it came, or to the reserve")]
unsafe impl GlobalAlloc for Reserving {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let block = unsafe { System.alloc(layout) };
        if block.is_null() { heap::alloc(layout) } else { block }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        if !heap::free(block, layout) {
            unsafe { System.dealloc(block, layout) }
        }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        let block = unsafe { System.alloc_zeroed(layout) };
        if !block.is_null() {
            return block;
        }
        let block = heap::alloc(layout);
        if !block.is_null() {
            unsafe { block.write_bytes(0, layout.size()) };
        }
        block
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        let new = unsafe { Layout::from_size_align_unchecked(size, layout.align()) };
        if heap::owns(block) {
            // The piece may have room as it is.
            if heap::size_of(new) == heap::size_of(layout) {
                return block;
            }
            return unsafe { self.moved(block, layout, new) };
        }
        let moved = unsafe { System.realloc(block, layout, size) };
        if moved.is_null() { unsafe { self.moved(block, layout, new) } } else { moved }
    }
}
