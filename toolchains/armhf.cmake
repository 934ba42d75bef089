# 32-bit ARM as Debian's armhf: ARMv7-A with VFPv3-D16, NEON not asked for.
set(ROOMCAL_TRIPLE arm-linux-gnueabihf)
set(ROOMCAL_PROCESSOR armv7l)
set(ROOMCAL_DEBIAN armhf)
set(ROOMCAL_QEMU qemu-arm-static)
# Times of 64 bits, beyond 2038; nothing of libraries that speak in struct timespec is linked.
set(CMAKE_C_FLAGS_INIT "-D_FILE_OFFSET_BITS=64 -D_TIME_BITS=64")
set(CMAKE_CXX_FLAGS_INIT "-D_FILE_OFFSET_BITS=64 -D_TIME_BITS=64")
include(${CMAKE_CURRENT_LIST_DIR}/common.cmake)
