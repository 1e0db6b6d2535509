//! The program `vitral`.

use vitral_cli::allocator;

/// Memory that runs out ends the program with a line and an exit code.
#[global_allocator]
static MEMORY: allocator::Exiting = allocator::Exiting;

/// Called by the loader, before Rust looks at the standard streams.
#[cfg(target_os = "linux")]
#[allow(unsafe_code)]
#[used]
#[unsafe(link_section = ".init_array")]
static AT_START: extern "C" fn() = allocator::note_closed_output;

fn main() {
    let code = vitral_cli::command(std::env::args_os().collect());
    // Freeing the scene piece by piece would only take time: the process ends here.
    std::process::exit(i32::from(code));
}
