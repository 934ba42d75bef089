# What the scripts of this folder know of a target; sourced. target TARGET sets: triple, debian (its name there), qemu
# (program of qemu-user), kernel (package that Debian's newest kernel of 12 comes by), full (whether full firmware exists).
target() {
  case "$1" in
    aarch64) triple=aarch64-linux-gnu debian=arm64 qemu=qemu-aarch64-static flavour=arm64 full=yes ;;
    armhf) triple=arm-linux-gnueabihf debian=armhf qemu=qemu-arm-static flavour=armmp full=yes ;;
    riscv64) triple=riscv64-linux-gnu debian=riscv64 qemu=qemu-riscv64-static flavour= full=no ;;
    x86_64) triple=x86_64-linux-gnu debian=amd64 qemu= flavour=amd64 full=no ;;
    *) echo "$1: not a target; known are aarch64, armhf, riscv64, x86_64" >&2; exit 2 ;;
  esac
}
# Packages that building for the target takes on the build machine.
target_packages() {
  echo cmake ninja-build ccache git make python3 libeigen3-dev libflatbuffers-dev flatbuffers-compiler googletest
  if [ "$1" = x86_64 ]; then echo g++-12 libgtest-dev
  else
    local cross=$triple
    echo "g++-12-$cross" qemu-user-static
  fi
}
