// For every test that draws text in a PDF. Fontconfig keeps its patterns behind offsets, which the leak checker cannot
// follow, so what it holds until the end of the program looks lost: 651 bytes, whatever is drawn.
// The name is the sanitizer's: https://clang.llvm.org/docs/LeakSanitizer.html, "Suppressions".
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libfontconfig\n"; }
