//! The program `vitral`.
#![forbid(unsafe_code)]

fn main() {
    let code = vitral_cli::command(std::env::args_os().collect());
    // Freeing the scene piece by piece would only take time: the process ends here.
    std::process::exit(i32::from(code));
}
