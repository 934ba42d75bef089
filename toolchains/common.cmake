# What all targets share; included by <target>.cmake, which says ROOMCAL_TRIPLE, ROOMCAL_PROCESSOR, ROOMCAL_DEBIAN (the
# architecture's name there) and ROOMCAL_QEMU.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR ${ROOMCAL_PROCESSOR})
set(CMAKE_LIBRARY_ARCHITECTURE ${ROOMCAL_TRIPLE})
set(CMAKE_C_COMPILER ${ROOMCAL_TRIPLE}-gcc-12)
set(CMAKE_CXX_COMPILER ${ROOMCAL_TRIPLE}-g++-12)
foreach(tool AR RANLIB)
  string(TOLOWER ${tool} name)
  set(CMAKE_${tool} ${ROOMCAL_TRIPLE}-gcc-${name}-12 CACHE FILEPATH "")
endforeach()
set(CMAKE_STRIP ${ROOMCAL_TRIPLE}-strip CACHE FILEPATH "")
set(CMAKE_OBJCOPY ${ROOMCAL_TRIPLE}-objcopy CACHE FILEPATH "")
set(CPACK_READELF_EXECUTABLE ${ROOMCAL_TRIPLE}-readelf)
set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE ${ROOMCAL_DEBIAN})
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES ROOMCAL_SYSROOT)

# Lean firmware sees two libraries of the build machine, both of headers only; full firmware a whole Debian of the
# target (./toolchains/sysroot). Neither sees /usr: a library that is missing there is missing, not the host's.
# Debian's compilers look for libc and libstdc++ beside themselves first, so these need no place in it.
set(build_folder ${CMAKE_CURRENT_LIST_DIR}/../build)
if(ROOMCAL_SYSROOT)
  set(CMAKE_SYSROOT ${ROOMCAL_SYSROOT})
else()
  set(CMAKE_SYSROOT ${build_folder}/sysroot/headers)
  foreach(path include/eigen3 include/flatbuffers share/eigen3)
    if(NOT EXISTS ${CMAKE_SYSROOT}/usr/${path})
      get_filename_component(folder ${CMAKE_SYSROOT}/usr/${path} DIRECTORY)
      file(MAKE_DIRECTORY ${folder})
      file(CREATE_LINK /usr/${path} ${CMAKE_SYSROOT}/usr/${path} SYMBOLIC)
    endif()
  endforeach()
endif()
get_filename_component(CMAKE_SYSROOT ${CMAKE_SYSROOT} ABSOLUTE)
set(CMAKE_FIND_ROOT_PATH ${CMAKE_SYSROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${CMAKE_SYSROOT})
set(ENV{PKG_CONFIG_LIBDIR}
    ${CMAKE_SYSROOT}/usr/lib/${ROOMCAL_TRIPLE}/pkgconfig:${CMAKE_SYSROOT}/usr/share/pkgconfig)

# -L matters to full firmware only: lean programs bring everything.
set(CMAKE_CROSSCOMPILING_EMULATOR ${ROOMCAL_QEMU} -L ${CMAKE_SYSROOT})
