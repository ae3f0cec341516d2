/* Makes one writing call fail: the FAULT_AT-th of this process, with the error FAULT_ERROR; with FAULT_STICKS every later one
   too, as on a full disk. FAULT_ERROR 0 is a short write. Standard streams are not affected. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdlib.h>
#include <sys/types.h>
#include <unistd.h>

static long calls;

static int fails(void) {
    const char *at = getenv("FAULT_AT"), *error = getenv("FAULT_ERROR");
    if (!at || !error) return 0;
    long call = __sync_add_and_fetch(&calls, 1), first = atol(at);
    if (call != first && !(getenv("FAULT_STICKS") && call > first)) return 0;
    errno = atoi(error);
    return 1;
}

#define REAL(type, name, ...) \
    static type (*real)(__VA_ARGS__); \
    if (!real) real = (type (*)(__VA_ARGS__))dlsym(RTLD_NEXT, name)

ssize_t write(int fd, const void *bytes, size_t count) {
    REAL(ssize_t, "write", int, const void *, size_t);
    if (fd > 2 && fails()) {
        if (errno) return -1;
        return real(fd, bytes, (count + 1) / 2);
    }
    return real(fd, bytes, count);
}

#define OTHER(name, parameters, arguments, ...) \
    int name parameters { \
        REAL(int, #name, __VA_ARGS__); \
        if (fails() && errno) return -1; \
        return real arguments; \
    }

OTHER(fsync, (int fd), (fd), int)
OTHER(fdatasync, (int fd), (fd), int)
OTHER(ftruncate, (int fd, off_t length), (fd, length), int, off_t)
OTHER(ftruncate64, (int fd, off_t length), (fd, length), int, off_t)
OTHER(rename, (const char *from, const char *to), (from, to), const char *, const char *)
OTHER(renameat, (int a, const char *from, int b, const char *to), (a, from, b, to), int, const char *, int, const char *)
OTHER(link, (const char *from, const char *to), (from, to), const char *, const char *)
OTHER(linkat, (int a, const char *from, int b, const char *to, int flags), (a, from, b, to, flags), int, const char *, int, const char *, int)
OTHER(unlink, (const char *path), (path), const char *)
OTHER(mkdir, (const char *path, mode_t mode), (path, mode), const char *, mode_t)
OTHER(flock, (int fd, int operation), (fd, operation), int, int)

#define OPENS(name) \
    int name(const char *path, int flags, ...) { \
        REAL(int, #name, const char *, int, ...); \
        va_list rest; \
        va_start(rest, flags); \
        mode_t mode = flags & O_CREAT ? va_arg(rest, mode_t) : 0; \
        va_end(rest); \
        if ((flags & (O_CREAT | O_WRONLY | O_RDWR)) && fails() && errno) return -1; \
        return real(path, flags, mode); \
    }

OPENS(open)
OPENS(open64)
