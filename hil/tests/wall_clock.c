/* A wall clock that is set while a program runs: forwards by a day after three
 * seconds, back by two days after five. Loaded before the program; nobody else
 * on the machine sees it. */
#define _GNU_SOURCE
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

static const time_t DAY_S = 86400;

static time_t began_s;

static time_t monotonic_s(void) {
    struct timespec now;
    syscall(SYS_clock_gettime, CLOCK_MONOTONIC, &now);
    return now.tv_sec;
}

__attribute__((constructor)) static void begin(void) { began_s = monotonic_s(); }

static time_t step_s(void) {
    time_t since_s = monotonic_s() - began_s;
    return since_s < 3 ? 0 : since_s < 5 ? DAY_S : -DAY_S;
}

int clock_gettime(clockid_t clock, struct timespec *now) {
    int answer = (int)syscall(SYS_clock_gettime, clock, now);
    if (answer == 0 && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE))
        now->tv_sec += step_s();
    return answer;
}

int gettimeofday(struct timeval *restrict now, void *restrict zone) {
    int answer = (int)syscall(SYS_gettimeofday, now, zone);
    if (answer == 0 && now)
        now->tv_sec += step_s();
    return answer;
}

time_t time(time_t *into) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    if (into)
        *into = now.tv_sec;
    return now.tv_sec;
}
