# How a target's program is made: hard to misuse, the same bytes every time, as small as it gets. Included at the top;
# changes nothing unless a preset asks for it.
option(ROOMCAL_HARDEN "Compile for a device: hardened, reproducible, unused functions left out" OFF)
option(ROOMCAL_STATIC "Link programs statically: no library on the device is needed" OFF)

if(ROOMCAL_HARDEN)
  # _FORTIFY_SOURCE is told again: Debian's compilers for some targets set it, and a definition twice is a warning.
  target_compile_options(roomcal_flags INTERFACE
    -fstack-protector-strong -fstack-clash-protection -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=2 -fPIE
    -ffunction-sections -fdata-sections -fno-ident
    -ffile-prefix-map=${CMAKE_BINARY_DIR}=build -ffile-prefix-map=${CMAKE_SOURCE_DIR}=.)
  if(CMAKE_SYSROOT)
    target_compile_options(roomcal_flags INTERFACE -ffile-prefix-map=${CMAKE_SYSROOT}=)
  endif()
  target_link_options(roomcal_flags INTERFACE
    -Wl,-z,relro,-z,now,-z,noexecstack,--gc-sections,--build-id=sha1,--as-needed)
endif()

if(ROOMCAL_STATIC)
  # A static program may still lie anywhere in memory, where libc has the start code for it.
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=rcrt1.o OUTPUT_VARIABLE rcrt1
                  OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(IS_ABSOLUTE ${rcrt1})
    target_link_options(roomcal_flags INTERFACE -static-pie)
  else()
    message(STATUS "${CMAKE_LIBRARY_ARCHITECTURE}'s libc has no rcrt1.o: static programs have fixed addresses")
    target_link_options(roomcal_flags INTERFACE -static -no-pie)
  endif()
  # Segments for pages of up to 16 KiB; the linker's own 64 KiB cost as much on flash and serve kernels of servers only.
  if(CMAKE_SYSTEM_PROCESSOR STREQUAL aarch64)
    target_link_options(roomcal_flags INTERFACE -Wl,-z,max-page-size=16384)
  endif()
  # Nothing of lean firmware throws (a library that does would end it, caught or not): no code for it. Tests may.
  target_compile_options(roomcal_flags INTERFACE
    $<$<NOT:$<BOOL:$<TARGET_PROPERTY:ROOMCAL_TEST>>>:-fno-exceptions$<SEMICOLON>-fno-asynchronous-unwind-tables>)
elseif(ROOMCAL_HARDEN)
  target_link_options(roomcal_flags INTERFACE -pie)
endif()
