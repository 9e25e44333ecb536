//! Room among the addresses of the process, by the system itself.
//!
//! A block of C's allocator would say nothing of it: a block that was given back stays with the allocator, and only
//! threads that share its arena have it again.

use std::num::NonZero;

/// Takes `size` bytes of addresses, on pages of their own. No memory is taken until something is written there.
///
/// Returns none if there is no room.
#[cfg(unix)]
#[allow(unsafe_code, reason = "a new mapping touches no memory that anybody has")]
pub(super) fn take(size: usize) -> Option<NonZero<usize>> {
    let access = libc::PROT_READ | libc::PROT_WRITE;
    let kind = libc::MAP_PRIVATE | libc::MAP_ANONYMOUS;
    let start = unsafe { libc::mmap(std::ptr::null_mut(), size, access, kind, -1, 0) };
    if start == libc::MAP_FAILED { None } else { NonZero::new(start.expose_provenance()) }
}

/// Gives back what [`take`] took.
///
/// # Safety
///
/// `start` and `size` are those of one `take`, and nobody uses the addresses any more.
#[cfg(unix)]
#[allow(unsafe_code, reason = "the caller promises that nobody uses the addresses")]
pub(super) unsafe fn give_back(start: NonZero<usize>, size: usize) {
    // A mapping that cannot be given back stays.
    unsafe { libc::munmap(std::ptr::with_exposed_provenance_mut(start.get()), size) };
}

#[cfg(not(unix))]
fn layout(size: usize) -> Option<std::alloc::Layout> {
    std::alloc::Layout::from_size_align(size.max(1), 4096).ok()
}

/// Takes `size` bytes. Returns none if there is no room.
#[cfg(not(unix))]
#[allow(unsafe_code, reason = "the layout has a size other than zero")]
pub(super) fn take(size: usize) -> Option<NonZero<usize>> {
    use std::alloc::{GlobalAlloc, System};
    // A block that nobody looks at would not be asked for.
    let start = std::hint::black_box(unsafe { System.alloc(layout(size)?) });
    NonZero::new(start.expose_provenance())
}

/// Gives back what [`take`] took.
///
/// # Safety
///
/// `start` and `size` are those of one `take`, and nobody uses the addresses any more.
#[cfg(not(unix))]
#[allow(unsafe_code, reason = "the caller promises that nobody uses the addresses")]
pub(super) unsafe fn give_back(start: NonZero<usize>, size: usize) {
    use std::alloc::{GlobalAlloc, System};
    if let Some(layout) = layout(size) {
        unsafe { System.dealloc(std::ptr::with_exposed_provenance_mut(start.get()), layout) };
    }
}
