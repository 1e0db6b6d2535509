//! Prints the hash of the picture as native code draws it.

fn main() {
    println!("{:016x}", vitral_wasm_probe::fnv1a(&vitral_wasm_probe::picture()));
}
