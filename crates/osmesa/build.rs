//! How the shared library is linked.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "linux") {
        for argument in [
            "-Wl,-soname,libOSMesa.so.8",
            // OSMesaGetProcAddress gives our functions, whatever other GL library is loaded.
            "-Wl,-Bsymbolic",
            // Worker threads run our code: dlclose must not take it away.
            "-Wl,-z,nodelete",
        ] {
            println!("cargo:rustc-cdylib-link-arg={argument}");
        }
    }
}
