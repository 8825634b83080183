/* Part of component.c: FMU states that are stored, restored, and carried as bytes. */

static const char STORED_MAGIC[8] = "FHSTATE";

/* What stands before the State in serialized form. The bytes are for the same FMU on the same
 * kind of machine; the token says whether they are. */
typedef struct {
    char magic[8];
    char token[sizeof MODEL_TOKEN];
    size_t size;
    uint64_t checksum;
} StoredHeader;

/* FNV-1a: bytes that were damaged on their way are not taken for a state. */
static uint64_t checksum(const void *bytes, size_t size) {
    uint64_t sum = UINT64_C(14695981039346656037);
    for (size_t i = 0; i < size; i++) {
        sum = (sum ^ ((const unsigned char *)bytes)[i]) * UINT64_C(1099511628211);
    }
    return sum;
}

static void fill_header(StoredHeader *header, const void *state) {
    memset(header, 0, sizeof *header);
    memcpy(header->magic, STORED_MAGIC, sizeof header->magic);
    memcpy(header->token, MODEL_TOKEN, sizeof header->token);
    header->size = sizeof(State);
    header->checksum = checksum(state, sizeof(State));
}

static Status component_get_stored(Component *component, void **stored) {
    if (!stored) {
        return null_argument(component, "Get FMU state");
    }
    if (!*stored) {
        *stored = malloc(sizeof(State));
    }
    if (!*stored) {
        return component_log(component, STATUS_ERROR, LOG_ERROR, "Get FMU state: out of memory.");
    }
    memcpy(*stored, &component->state, sizeof(State));
    return STATUS_OK;
}

static Status component_set_stored(Component *component, const char *call, const void *stored) {
    const State *state = stored;
    if (!state) {
        return null_argument(component, call);
    }
    if (component_check_kind(component, call, state->kind) != STATUS_OK) {
        return STATUS_ERROR;
    }
    memcpy(&component->state, state, sizeof(State));
    invalidate(component);
    return STATUS_OK;
}

static Status component_free_stored(void **stored) {
    if (stored) {
        free(*stored);
        *stored = NULL;
    }
    return STATUS_OK;
}

static size_t component_serialized_size(void) { return sizeof(StoredHeader) + sizeof(State); }

static Status component_serialize(Component *component, const char *call, const void *stored,
                                  void *bytes, size_t size) {
    StoredHeader header;
    if (!stored || !bytes) {
        return null_argument(component, call);
    }
    if (size < component_serialized_size()) {
        return component_log(component, STATUS_ERROR, LOG_ERROR,
                             "%s: %lu bytes are too few, the state takes %lu.", call,
                             (unsigned long)size, (unsigned long)component_serialized_size());
    }
    fill_header(&header, stored);
    memcpy(bytes, &header, sizeof header);
    memcpy((char *)bytes + sizeof header, stored, sizeof(State));
    return STATUS_OK;
}

static Status component_deserialize(Component *component, const char *call, const void *bytes,
                                    size_t size, void **stored) {
    StoredHeader header;
    if (!bytes || !stored) {
        return null_argument(component, call);
    }
    if (size == component_serialized_size()) {
        fill_header(&header, (const char *)bytes + sizeof header);
    }
    if (size != component_serialized_size() || memcmp(bytes, &header, sizeof header) != 0) {
        return component_log(component, STATUS_ERROR, LOG_ERROR,
                             "%s: the %lu bytes are no state of this FMU, or are damaged.", call,
                             (unsigned long)size);
    }
    *stored = malloc(sizeof(State)); /* the handle may come uninitialised: it is only written */
    if (!*stored) {
        return component_log(component, STATUS_ERROR, LOG_ERROR, "%s: out of memory.", call);
    }
    memcpy(*stored, (const char *)bytes + sizeof header, sizeof(State));
    return STATUS_OK;
}
