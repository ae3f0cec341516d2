//! The command `stripmine`. When the system runs out of memory, it ends with a message and an exit code instead of an abort.

use std::alloc::{GlobalAlloc, Layout, System};
use std::process::ExitCode;

fn main() -> ExitCode {
    limits::prepare();
    stripmine::cli::run(std::env::args_os())
}

/// The system allocator, with a message when no memory is left. Without it the program would be aborted.
struct ReportingAllocator;

#[global_allocator]
static ALLOCATOR: ReportingAllocator = ReportingAllocator;

// SAFETY: every block comes from the system allocator; when it fails, no call returns.
unsafe impl GlobalAlloc for ReportingAllocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as the caller promises.
        limits::block_or_end(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as the caller promises.
        limits::block_or_end(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as the caller promises.
        limits::block_or_end(unsafe { System.realloc(block, layout, size) }, size)
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(block, layout) }
    }
}

#[cfg(unix)]
mod limits {
    use std::fmt::{self, Write};
    use std::sync::atomic::{AtomicBool, Ordering};
    use stripmine::console::is_untouched;
    use stripmine_physics::reported::ErrorClass;

    /// Set by `--json`.
    static AS_DATA: AtomicBool = AtomicBool::new(false);
    static IS_ENDING: AtomicBool = AtomicBool::new(false);

    const REMEDY: &str = "raise the memory limit (ulimit -v, ulimit -d, control group), or use fewer particles, --ranks or --threads";

    /// Limits reserved memory where the address space is limited: glibc would reserve 64 MiB for each thread.
    pub(super) fn prepare() {
        AS_DATA.store(std::env::args_os().any(|argument| argument == "--json"), Ordering::Relaxed);
        #[cfg(all(target_os = "linux", target_env = "gnu"))]
        {
            let mut limit = libc::rlimit { rlim_cur: 0, rlim_max: 0 };
            // SAFETY: both calls get arguments of the declared types, and there is one thread.
            unsafe {
                if libc::getrlimit(libc::RLIMIT_AS, &raw mut limit) == 0
                    && limit.rlim_cur != libc::RLIM_INFINITY
                {
                    libc::mallopt(libc::M_ARENA_MAX, 1);
                }
            }
        }
    }

    /// Returns the block; ends the program if it is null.
    #[inline]
    pub(super) fn block_or_end(block: *mut u8, bytes: usize) -> *mut u8 {
        if block.is_null() {
            end_out_of_memory(bytes);
        }
        block
    }

    /// Message on the stack, since there is no other memory.
    struct StackMessage {
        bytes: [u8; 512],
        length: usize,
    }

    impl Write for StackMessage {
        fn write_str(&mut self, text: &str) -> fmt::Result {
            let end = self.length + text.len();
            self.bytes.get_mut(self.length..end).ok_or(fmt::Error)?.copy_from_slice(text.as_bytes());
            self.length = end;
            Ok(())
        }
    }

    fn write_message(to: i32, words: fmt::Arguments<'_>) {
        let mut said = StackMessage { bytes: [0; 512], length: 0 };
        let _ = said.write_fmt(words);
        // SAFETY: `length` bytes were written there. A failed write cannot be reported anywhere.
        let _ = unsafe { libc::write(to, said.bytes.as_ptr().cast(), said.length) };
    }

    #[cold]
    fn end_out_of_memory(bytes: usize) -> ! {
        // Only one thread prints the message.
        while IS_ENDING.swap(true, Ordering::SeqCst) {
            std::thread::yield_now();
        }
        write_message(
            2,
            format_args!("error: out of memory: {bytes} bytes could not be allocated\n  help: {REMEDY}\n"),
        );
        if AS_DATA.load(Ordering::Relaxed) && is_untouched() {
            let kind = ErrorClass::InputOutput.name();
            write_message(
                1,
                format_args!(
                    "{{\"error\": {{\"kind\": \"{kind}\", \"message\": \"out of memory: {bytes} bytes could not be allocated\", \"place\": null, \"remedy\": \"{REMEDY}\"}}}}\n"
                ),
            );
        }
        // SAFETY: ends the process without exit handlers, which would allocate.
        unsafe { libc::_exit(ErrorClass::InputOutput.exit_code().into()) }
    }
}

#[cfg(not(unix))]
mod limits {
    pub(super) fn prepare() {}

    #[inline]
    pub(super) fn block_or_end(block: *mut u8, _: usize) -> *mut u8 {
        block
    }
}
