/* number.h - a number that remembers how it was made. It takes the place of double in the library (FB_REAL of flexbeam.h),
   so that whatever the library computes leaves a graph of operations behind. A number is a double, or, in a NaN of its
   own kind, the index of a node of the graph: it has the size and layout of double, so that models are copied as they
   are, and memory that is cleared is zero. */
#ifndef TRACE_NUMBER_H
#define TRACE_NUMBER_H
#include <cstddef>
#include <cstdint>
#include <cstring>

#if FB_SINGLE /* both precisions in one program */
#define trace trace_single
#endif
namespace trace
{

enum { FB_TRACE_MOST = FB_MAX_MODES > 6 ? FB_MAX_MODES *FB_MAX_MODES : 36 };

struct number {
  double d;
  number() = default;
  constexpr number(double x) : d(x)
  {
  }
  constexpr number(float x) : d((double)x)
  {
  }
  constexpr number(int x) : d(x)
  {
  }
  constexpr number(unsigned x) : d(x)
  {
  }
  constexpr number(long x) : d((double)x)
  {
  }
  constexpr number(unsigned long x) : d((double)x)
  {
  }
  explicit operator double() const; /* its value where the graph was made */
  explicit operator float() const
  {
    return (float)(double)*this;
  }
  explicit operator int() const; /* stops the generator where it depends on inputs */
  explicit operator unsigned() const
  {
    return (unsigned)(int)*this;
  }
  explicit operator long() const
  {
    return (int)*this;
  }
};

const std::uint64_t number_tag = 0x7FFDull << 48; /* no operation makes such a NaN */

inline std::uint64_t bits(number a)
{
  std::uint64_t u;
  std::memcpy(&u, &a, sizeof u);
  return u;
}

/* Index of its node; 0: a constant. */
inline int node_of(number a)
{
  return bits(a) >> 48 == number_tag >> 48 ? (int)(bits(a) & 0xFFFFFFFFu) : 0;
}

/* The graph in which it is a node. */
inline int graph_of(number a)
{
  return (int)(bits(a) >> 32 & 0xFFFFu);
}

inline number number_of(int graph, int node)
{
  const std::uint64_t u = number_tag | (std::uint64_t)(unsigned)graph << 32 | (std::uint64_t)(unsigned)node;
  number a;
  std::memcpy(&a, &u, sizeof a);
  return a;
}

/* What operations are called in the graph: + - * / as they are, n -a, q sqrt, s sin, c cos, t atan2, f fabs, e exp,
   z towards zero, < 1 where a < b, else 0; ? b where a is not zero, else c; i input a; k the call of kernel a, l of loop a,
   r result b of call a, of a loop in iteration c, o result a of what is not traced (apart.h); m number a of the
   model, the same in all kernels; v largest eigenvalue of the two matrices of list a. */
number apply(char op, number a, number b = number(0));
number select(char relation, number a, number b, number yes, number no); /* yes where a < b, else no: no branch */
bool ask(char relation, number a, number b);                             /* a branch: <, l for <=, = */
bool is_recording();
bool guess(bool begins); /* does what is asked until it ends depend on no input? */
void apart(void *work);  /* fbi_rows_apart */
bool set_aside(const number *A, const number *B,
               int n); /* does one depend on inputs? Then nothing is recorded until.. */
number take_up(const number *A, const number *B, int n, number largest); /* ..here, the result as one operation */
void kernel_begin(const char *call);
void kernel_end();
void carry_numbers(number *at, std::size_t n);

/* What is not computed where `applies`: taken where that holds for every input. */
template <class function> bool shortcut(function applies)
{
  if (!is_recording()) {
    return applies();
  }
  guess(true);
  const bool taken = applies();
  return guess(false) && taken;
}

/* A part that is called in a loop takes n structs of numbers from one turn to the next. */
template <class numbers> void carry(numbers *memory, int n)
{
  carry_numbers((number *)memory, (std::size_t)n * sizeof *memory / sizeof(number));
}

struct kernel_scope {
  explicit kernel_scope(const char *call)
  {
    kernel_begin(call);
  }
  ~kernel_scope()
  {
    kernel_end();
  }
};

template <class function> auto kernel(const char *call, function f) -> decltype(f())
{
  const kernel_scope scope(call);
  return f();
}

bool loop_begin(bool pairs);
void loop_next();
void loop_end();
void span(const number *x, int n);

/* A loop whose iterations the graph keeps apart. */
class marked_loop
{
  bool on, once = true;

public:
  explicit marked_loop(bool pairs) : on(loop_begin(pairs))
  {
  }
  marked_loop(const marked_loop &) = delete;
  ~marked_loop()
  {
    iterate(false);
  }
  bool enter()
  {
    const bool first = once;
    once = false;
    return first;
  }
  bool iterate(bool more)
  {
    if (on) {
      more ? loop_next() : loop_end();
      on = more;
    }
    return more;
  }
};

/* An iteration that is not followed: d is one operation of A and B, n x n, which it may overwrite. */
template <class function> auto largest(number *d, number *A, number *B, int n, function f) -> decltype(f())
{
  number before[2][FB_TRACE_MOST];
  if (!set_aside(A, B, n)) {
    return f();
  }
  for (int i = 0; i < n * n; i++) {
    before[0][i] = A[i];
    before[1][i] = B[i];
    A[i] = number((double)A[i]);
    B[i] = number((double)B[i]);
  }
  const auto status = f();
  *d = take_up(before[0], before[1], n, *d);
  return status;
}

inline number operator+(number a, number b)
{
  return apply('+', a, b);
}
inline number operator-(number a, number b)
{
  return apply('-', a, b);
}
inline number operator*(number a, number b)
{
  return apply('*', a, b);
}
inline number operator/(number a, number b)
{
  return apply('/', a, b);
}
inline number operator-(number a)
{
  return apply('n', a);
}
inline number operator+(number a)
{
  return a;
}
inline number &operator+=(number &a, number b)
{
  return a = a + b;
}
inline number &operator-=(number &a, number b)
{
  return a = a - b;
}
inline number &operator*=(number &a, number b)
{
  return a = a * b;
}
inline number &operator/=(number &a, number b)
{
  return a = a / b;
}
inline bool operator<(number a, number b)
{
  return ask('<', a, b);
}
inline bool operator>(number a, number b)
{
  return ask('<', b, a);
}
inline bool operator<=(number a, number b)
{
  return ask('l', a, b);
}
inline bool operator>=(number a, number b)
{
  return ask('l', b, a);
}
inline bool operator==(number a, number b)
{
  return ask('=', a, b);
}
inline bool operator!=(number a, number b)
{
  return !ask('=', a, b);
}

} // namespace trace

#define FB_REAL trace::number
#define FB_SQRT(x) trace::apply('q', x)
#define FB_SIN(x) trace::apply('s', x)
#define FB_COS(x) trace::apply('c', x)
#define FB_ATAN2(y, x) trace::apply('t', y, x)
#define FB_FABS(x) trace::apply('f', x)
#define FB_EXP(x) trace::apply('e', x)
#define FB_TRUNC(x) trace::apply('z', x)
#define FB_BELOW(x, y, yes, no) trace::select('<', x, y, yes, no)
#define FB_SHORTCUT(applies) trace::shortcut([&] { return applies; })
#define FB_APART(function, work) trace::apart(work)
#define FB_CARRY(memory, n) trace::carry(memory, n)
#define FB_LARGEST(call, d, A, B, n) trace::largest(d, A, B, n, [&] { return call; })
#define FB_KERNEL(call) trace::kernel(#call, [&] { return call; })
#define TRACE_LOOP(pairs, first, more, next)              \
  for (trace::marked_loop marked(pairs); marked.enter();) \
    for (first; marked.iterate(more); next)
#define FB_LOOP(first, more, next) TRACE_LOOP(false, first, more, next)
#define FB_PAIRS(first, more, next) TRACE_LOOP(true, first, more, next)
#define FB_SPAN(x, n) trace::span(x, n)
#endif
