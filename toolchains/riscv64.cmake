# 64-bit RISC-V, rv64gc. No architecture of Debian 12, which has its compiler all the same: lean firmware only.
set(ROOMCAL_TRIPLE riscv64-linux-gnu)
set(ROOMCAL_PROCESSOR riscv64)
set(ROOMCAL_DEBIAN riscv64)
set(ROOMCAL_QEMU qemu-riscv64-static)
include(${CMAKE_CURRENT_LIST_DIR}/common.cmake)
