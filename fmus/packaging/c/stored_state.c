/* Part of component.c: FMU states that are stored, restored, and carried as bytes. */

static const char STORED_MAGIC[8] = "FHSTATE";

/* What stands before the State in serialized form. The bytes are for the same FMU on the same
 * kind of machine; the token says whether they are. */
typedef struct {
    char magic[8];
    char token[sizeof MODEL_TOKEN];
    size_t size;
} StoredHeader;

static void fill_header(StoredHeader *header) {
    memset(header, 0, sizeof *header);
    memcpy(header->magic, STORED_MAGIC, sizeof header->magic);
    memcpy(header->token, MODEL_TOKEN, sizeof header->token);
    header->size = sizeof(State);
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
    fill_header(&header);
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
    fill_header(&header);
    if (size < component_serialized_size() || memcmp(bytes, &header, sizeof header) != 0) {
        return component_log(component, STATUS_ERROR, LOG_ERROR,
                             "%s: the bytes are no state of this FMU.", call);
    }
    *stored = malloc(sizeof(State)); /* the handle may come uninitialised: it is only written */
    if (!*stored) {
        return component_log(component, STATUS_ERROR, LOG_ERROR, "%s: out of memory.", call);
    }
    memcpy(*stored, (const char *)bytes + sizeof header, sizeof(State));
    return STATUS_OK;
}
