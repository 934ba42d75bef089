# 64-bit ARM, any ARMv8-A.
set(ROOMCAL_TRIPLE aarch64-linux-gnu)
set(ROOMCAL_PROCESSOR aarch64)
set(ROOMCAL_DEBIAN arm64)
set(ROOMCAL_QEMU qemu-aarch64-static)
# Return addresses signed and branch targets marked, where the processor can; nothing to processors that cannot.
set(CMAKE_CXX_FLAGS_INIT "-mbranch-protection=standard")
include(${CMAKE_CURRENT_LIST_DIR}/common.cmake)
