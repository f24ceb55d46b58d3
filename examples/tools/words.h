/* words.h - the words of build/flexbeam. Each is a translation unit with a main of its own; all are linked with
   library.c. `cc -Dreduce_main=main reduce.c library.c` is `reduce` alone. */
#ifndef WORDS_H
#define WORDS_H

#define WORDS(X)                                                                                 \
  X(scene, "runs a scene from a text file: bodies, joints, loads; to CSV, pictures, animations") \
  X(campaign, "runs one scene over many sets of parameters on all cores")                        \
  X(reduce, "a body from a text file to a C header: a model in ROM")                             \
  X(fmu, "a body from a text file to an FMU for co-simulation, FMI 2.0 or 3.0")                  \
  X(elastodyn, "a blade of OpenFAST to a text file for reduce")                                  \
  X(analyse, "steady spin of a body: deflection, modes, damping, stability margin, step")        \
  X(advise, "which effects, modes, integrator and step a body needs")                            \
  X(exact, "a geometrically exact beam: deflection, root loads, frequencies")

#define WORD_PROTOTYPE(name, what) int name##_main(int argc, char **argv);
WORDS(WORD_PROTOTYPE)
#undef WORD_PROTOTYPE

#endif
