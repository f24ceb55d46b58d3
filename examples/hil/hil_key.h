/* hil_key.h - where hil_plant and hil_controller have their key and their random numbers from. Include hil_hash.h and
   options.h before; wants POSIX: define _POSIX_C_SOURCE 200809L. */
#ifndef HIL_KEY_H
#define HIL_KEY_H
#include <fcntl.h>
#include <stddef.h>
#include <sys/stat.h>
#include <unistd.h>

static const char key_variable[] = "HIL_KEY", key_default[] = "hil.key";

/* 1 if the system has given n random bytes. */
static inline int key_random(unsigned char *bytes, size_t n)
{
  FILE *file = fopen("/dev/urandom", "rb");
  size_t got = 0;
  if (file) {
    setvbuf(file, NULL, _IONBF, 0);
    got = fread(bytes, 1, n, file);
    fclose(file);
  }
  return got == n;
}

/* 32 hexadecimal digits, perhaps with an end of line: 1. */
static inline int key_from_text(hil_key *key, const char *text)
{
  static const char digits[] = "0123456789abcdef0123456789ABCDEF";
  const size_t n = strspn(text, "0123456789abcdefABCDEF");
  if (n != 2 * HIL_KEY || text[n + strspn(text + n, "\r\n")]) {
    return 0;
  }
  memset(key, 0, sizeof *key);
  for (int i = 0; i < 2 * HIL_KEY; i++) {
    key->byte[i / 2] = (unsigned char)(16 * key->byte[i / 2] + (strchr(digits, text[i]) - digits) % 16);
  }
  return 1;
}

/* A file with a new key; of two programs that make it at once, one does. 0, or errno. */
static inline int key_make(const char *name)
{
  unsigned char bytes[HIL_KEY];
  char fresh[64], text[2 * HIL_KEY + 2];
  int file, ok, error;
  if (!key_random(bytes, sizeof bytes)) {
    return errno ? errno : EIO;
  }
  for (int i = 0; i < HIL_KEY; i++) {
    snprintf(text + (ptrdiff_t)2 * i, 4, "%02x\n", bytes[i]);
  }
  snprintf(fresh, sizeof fresh, "%.32s.%ld.new", name, (long)getpid());
  file = open(fresh, O_WRONLY | O_CREAT | O_EXCL, 0600);
  if (file < 0) {
    return errno;
  }
  ok = write(file, text, strlen(text)) == (ssize_t)strlen(text);
  ok = close(file) == 0 && ok && (link(fresh, name) == 0 || errno == EEXIST);
  error = ok ? 0 : errno;
  unlink(fresh);
  return error;
}

static inline int key_from_file(hil_key *key, const char *name)
{
  char text[64] = "";
  struct stat at;
  FILE *file = stat(name, &at) == 0 && S_ISREG(at.st_mode) ? fopen(name, "r") : NULL; /* a pipe would be waited for */
  if (!file) {
    return fail("the key: cannot be read", name);
  }
  (void)fgets(text, sizeof text, file); /* none: no key */
  if (fstat(fileno(file), &at) != 0 || (at.st_mode & (S_IRWXG | S_IRWXO))) {
    fclose(file);
    return fail("the key: others may read or write its file (chmod 600)", name);
  }
  fclose(file);
  return key_from_text(key, text) ? 0 : fail("the key: is no line of 32 hexadecimal digits", name);
}

/* The key: from the file, if one is named; else from the environment, HIL_KEY; else from hil.key in the working
   directory, which is made if it is not there. 0, or 2 after a message. */
static inline int key_read(hil_key *key, const char *name)
{
  const char *const text = getenv(key_variable);
  if (name) {
    return key_from_file(key, name);
  }
  if (text) {
    return key_from_text(key, text) ? 0 : fail("the key: HIL_KEY wants 32 hexadecimal digits", "");
  }
  if (access(key_default, F_OK) != 0) {
    const int error = key_make(key_default);
    if (error) {
      return fail("the key: hil.key cannot be made", strerror(error));
    }
  }
  return key_from_file(key, key_default);
}
#endif
