/* A Vulkan layer between the program and its driver: the next submission after the file `lose`
 * appears in the folder $LOSE is answered with VK_ERROR_DEVICE_LOST, or, after the file `lose-shown`,
 * the next one that draws to the window. It takes the file away. With a file `blind` there, no adapter
 * can draw to windows. The structures are those of
 * vk_layer.h, which few machines have. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef void (*Function)(void);
typedef Function (*Find)(void *, const char *);

struct Link {
    struct Link *next;
    Find of_instance, of_device;
};

struct Info {
    int32_t type;
    const struct Info *next;
    int32_t function;
    struct Link *link;
};

static Find instance_below, device_below;
static int32_t (*submit_below)(void *, uint32_t, const void *, void *);

/* The layer below, by the structure of a type in the chain of what is created. */
static struct Link *below(const struct Info *created, int32_t type) {
    struct Info *info = (struct Info *)created->next;
    while (info->type != type || info->function != 0)
        info = (struct Info *)info->next;
    struct Link *link = info->link;
    info->link = link->next;
    return link;
}

static int32_t create_instance(const struct Info *info, const void *allocator, void **instance) {
    instance_below = below(info, 47)->of_instance;
    int32_t (*create)(const void *, const void *, void **) =
        (void *)instance_below(NULL, "vkCreateInstance");
    return create(info, allocator, instance);
}

static int32_t create_device(void *adapter, const struct Info *info, const void *allocator,
                             void **device) {
    struct Link *link = below(info, 48);
    device_below = link->of_device;
    int32_t (*create)(void *, const void *, const void *, void **) =
        (void *)link->of_instance(NULL, "vkCreateDevice");
    int32_t created = create(adapter, info, allocator, device);
    if (created == 0)
        submit_below = (void *)device_below(*device, "vkQueueSubmit");
    return created;
}

static int in_folder(const char *name, int (*call)(const char *)) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", getenv("LOSE"), name);
    return call(path) == 0;
}

static int is_asked(const char *name) { return in_folder(name, unlink); }

static int is_there(const char *path) { return access(path, F_OK); }

static int32_t submit(void *queue, uint32_t count, const void *infos, void *fence) {
    /* A submission waits for the one before, and one that draws to the window also for its image. */
    uint32_t waits = count ? ((const uint32_t *)infos)[4] : 0;
    if (is_asked("lose") || (waits > 1 && is_asked("lose-shown")))
        return -4;
    return submit_below(queue, count, infos, fence);
}

/* Whether a family of queues of an adapter can draw to a surface. */
static int32_t no_surface(void *adapter, uint32_t family, uint64_t surface, uint32_t *supported) {
    *supported = 0;
    return 0;
}

Function find_of_device(void *device, const char *name) {
    if (!strcmp(name, "vkGetDeviceProcAddr"))
        return (Function)find_of_device;
    if (!strcmp(name, "vkQueueSubmit"))
        return (Function)submit;
    return device_below(device, name);
}

Function find_of_instance(void *instance, const char *name) {
    if (!strcmp(name, "vkGetInstanceProcAddr"))
        return (Function)find_of_instance;
    if (!strcmp(name, "vkCreateInstance"))
        return (Function)create_instance;
    if (!strcmp(name, "vkCreateDevice"))
        return (Function)create_device;
    if (!strcmp(name, "vkGetDeviceProcAddr"))
        return (Function)find_of_device;
    if (!strcmp(name, "vkGetPhysicalDeviceSurfaceSupportKHR") && in_folder("blind", is_there))
        return (Function)no_surface;
    if (!strcmp(name, "vkQueueSubmit"))
        return (Function)submit;
    return instance_below ? instance_below(instance, name) : NULL;
}
