#pragma once

// A function over plain loops of floats, compiled several times on x86-64 and chosen when the program starts. Every
// operation is the same IEEE one on each lane (-ffp-contract=off), and sums run over a fixed number of lanes: all
// clones, and other processors, give the same bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define ROOMCAL_VECTOR_CLONES [[gnu::flatten, gnu::target_clones("avx512f", "avx2", "default")]]
#else
#define ROOMCAL_VECTOR_CLONES
#endif
